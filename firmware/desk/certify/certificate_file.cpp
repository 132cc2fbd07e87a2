// The file that proves a bound.
#include "desk/certify/certificate_file.hpp"

#include <cstddef>
#include <cstdint>

#include "emax/app/base/version.hpp"

namespace emax::desk {

namespace {

using app::TextWriter;

void write_list(const char* name, Span<const double> values, TextWriter& out) noexcept {
  out.text(" \"").text(name).text("\": [");
  for (std::size_t i = 0; i < values.size(); ++i) {
    out.text(i == 0 ? "" : ", ").exact(values[i]);
  }
  out.text("],\n");
}

void write_about(const ProvenEnergy& proven, TextWriter& out) noexcept {
  const Accelerometer& device = proven.model->device();
  const ReferenceFilter& filter = proven.model->filter();
  out.text(" \"certificate\": 2,\n \"version\": \"").text(app::kVersion).text("\",\n");
  out.text(" \"model\": {\"S\": ").exact(device.sensitivity);
  out.text(", \"f0\": ").exact(device.natural_frequency_hz);
  out.text(", \"beta\": ").exact(device.damping);
  out.text(", \"order\": ").integer(static_cast<std::uint64_t>(filter.relative_degree));
  out.text(", \"cutoff\": ").exact(filter.band_hz);
  out.text(", \"gain\": ").exact(filter.gain);
  switch (proven.model->criterion()) {
    case Criterion::kInBandError:
      out.text(", \"criterion\": \"band\", \"delay\": ").exact(proven.model->delay_s());
      break;
    case Criterion::kEnergyDifference:
      out.text(", \"criterion\": \"difference\"");
      break;
    case Criterion::kIntegralSquareError:
      break;
  }
  out.text("},\n");
  out.text(" \"signal\": {\"T\": ").exact(proven.signal->duration_s());
  out.text(", \"a\": ").exact(proven.limit_mps2).text("},\n");
  out.text(" \"energy\": {\"E\": ").exact(proven.energy_v2s).text(", \"switch_times\": [");
  const Span<const double> times_s = proven.signal->times_s();
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    out.text(i == 0 ? "" : ", ").exact(times_s[i]);
  }
  out.text("]},\n \"bound\": ").exact(proven.bound_v2s()).text(",\n");
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

void write_certificate(const ProvenEnergy& proven, TextWriter& out) noexcept {
  const EnergyCertificate& certificate = *proven.certificate;
  out.text("{\n");
  write_about(proven, out);
  const CertificateGrid& grid = certificate.grid();
  write_list("edges", Span<const double>(grid.edges_s).first(grid.cells + 1), out);
  write_list("costs", Span<const double>(grid.costs).first(grid.cells), out);
  out.text(" \"unit\": ").exact(certificate.unit()).text(",\n");
  write_multipliers(certificate, out);
  out.text(" \"y\": [");
  const char* separator = "";
  for (const std::int32_t units : certificate.duals()) {
    out.text(separator).integer(static_cast<std::uint64_t>(units));
    separator = ",";
  }
  out.text("]\n}\n");
}

}  // namespace emax::desk
