// The file that proves a bound.
#include "desk/certify/certificate_file.hpp"

#include <cstddef>
#include <cstdint>

#include "emax/app/base/version.hpp"

namespace emax::desk {

namespace {

using app::TextWriter;

void write_values(Span<const double> values, TextWriter& out) noexcept {
  out.text("[");
  for (std::size_t i = 0; i < values.size(); ++i) {
    out.text(i == 0 ? "" : ", ").exact(values[i]);
  }
  out.text("]");
}

void write_list(const char* name, Span<const double> values, TextWriter& out) noexcept {
  out.text(" \"").text(name).text("\": ");
  write_values(values, out);
  out.text(",\n");
}

void write_criterion(const ModalModel& model, TextWriter& out) noexcept {
  switch (model.criterion()) {
    case Criterion::kInBandError:
      out.text(", \"criterion\": \"band\", \"delay\": ").exact(model.delay_s());
      break;
    case Criterion::kEnergyDifference:
      out.text(", \"criterion\": \"difference\"");
      break;
    case Criterion::kIntegralSquareError:
      break;
  }
  out.text("},\n");
}

// A device, or knots along the sides of a box.
void write_devices(const ProvenEnergy& proven, TextWriter& out) {
  const ReferenceFilter& filter = proven.model->filter();
  if (proven.box == nullptr) {
    const Accelerometer& device = proven.model->device();
    out.text(" \"model\": {\"S\": ").exact(device.sensitivity);
    out.text(", \"f0\": ").exact(device.natural_frequency_hz);
    out.text(", \"beta\": ").exact(device.damping);
  } else {
    out.text(" \"box\": {\"S\": ");
    write_values(proven.box->sensitivities(), out);
    out.text(", \"f0\": ");
    write_values(proven.box->frequencies_hz(), out);
    out.text(", \"beta\": ");
    write_values(proven.box->dampings(), out);
  }
  out.text(", \"order\": ").integer(static_cast<std::uint64_t>(filter.relative_degree));
  out.text(", \"cutoff\": ").exact(filter.band_hz);
  if (proven.box != nullptr && proven.box->gain_follows()) {
    out.text(", \"gain\": null");
  } else {
    out.text(", \"gain\": ").exact(filter.gain);
  }
  write_criterion(*proven.model, out);
}

void write_about(const ProvenEnergy& proven, TextWriter& out) {
  out.text(" \"certificate\": ").integer(proven.box == nullptr ? 2 : 3);
  out.text(",\n \"version\": \"").text(app::kVersion).text("\",\n");
  write_devices(proven, out);
  out.text(" \"signal\": {\"T\": ").exact(proven.signal->duration_s());
  out.text(", \"a\": ").exact(proven.limit_mps2).text("},\n");
  out.text(" \"energy\": {\"E\": ").exact(proven.energy_v2s);
  if (proven.box != nullptr) {
    const Accelerometer& device = proven.box->device();
    out.text(", \"S\": ").exact(device.sensitivity);
    out.text(", \"f0\": ").exact(device.natural_frequency_hz);
    out.text(", \"beta\": ").exact(device.damping);
  }
  out.text(", \"switch_times\": ");
  write_values(proven.signal->times_s(), out);
  out.text("},\n \"bound\": ").exact(proven.bound_v2s()).text(",\n");
  if (proven.box != nullptr) {
    out.text(" \"curvature\": {\"f0\": ").exact(proven.box->terms().frequency);
    out.text(", \"beta\": ").exact(proven.box->terms().damping).text("},\n");
  }
}

void write_duals(Span<const std::int32_t> duals, TextWriter& out) noexcept {
  const char* separator = "[";
  for (const std::int32_t units : duals) {
    out.text(separator).integer(static_cast<std::uint64_t>(units));
    separator = ",";
  }
  out.text("]");
}

void write_multipliers(const EnergyCertificate& certificate, TextWriter& out) noexcept {
  out.text(" \"multipliers\": [");
  const char* separator = "\n  ";
  for (const TriangleMultiplier& multiplier : certificate.multipliers()) {
    if (multiplier.units == 0) {
      continue;
    }
    out.text(separator).text("[").integer(multiplier.i);
    out.text(",").integer(multiplier.j);
    out.text(",").integer(multiplier.k);
    out.text(",").integer(multiplier.kind);
    out.text(",").integer(static_cast<std::uint64_t>(multiplier.units)).text("]");
    separator = ",\n  ";
  }
  out.text("],\n");
}

}  // namespace

void write_certificate(const ProvenEnergy& proven, TextWriter& out) {
  const EnergyCertificate& certificate = *proven.certificate;
  out.text("{\n");
  write_about(proven, out);
  const CertificateGrid& grid = certificate.grid();
  write_list("edges", Span<const double>(grid.edges_s).first(grid.cells + 1), out);
  write_list("costs", Span<const double>(grid.costs).first(grid.cells), out);
  out.text(" \"unit\": ").exact(certificate.unit()).text(",\n");
  write_multipliers(certificate, out);
  out.text(" \"y\": ");
  if (proven.box == nullptr) {
    write_duals(certificate.duals(), out);
  } else {
    for (std::size_t corner = 0; corner < proven.box->models().size(); ++corner) {
      out.text(corner == 0 ? "[" : ",\n  ");
      write_duals(proven.box->duals(corner), out);
    }
    out.text("]");
  }
  out.text("\n}\n");
}

}  // namespace emax::desk
