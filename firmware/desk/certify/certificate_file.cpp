// The file that proves a bound.
#include "desk/certify/certificate_file.hpp"

#include <cstddef>
#include <cstdint>

#include "emax/app/base/version.hpp"

namespace emax::desk {

namespace {

using app::TextWriter;

constexpr std::uint8_t kFreeKind = 4;

void write_signed(std::int32_t value, TextWriter& out) noexcept {
  const std::int64_t wide = value;
  out.text(wide < 0 ? "-" : "").integer(static_cast<std::uint64_t>(wide < 0 ? -wide : wide));
}

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
  out.text(" \"certificate\": 1,\n \"version\": \"").text(app::kVersion).text("\",\n");
  out.text(" \"model\": {\"S\": ").exact(device.sensitivity);
  out.text(", \"f0\": ").exact(device.natural_frequency_hz);
  out.text(", \"beta\": ").exact(device.damping);
  out.text(", \"order\": ").integer(static_cast<std::uint64_t>(filter.relative_degree));
  out.text(", \"cutoff\": ").exact(filter.band_hz);
  out.text(", \"gain\": ").exact(filter.gain);
  const bool is_in_band = proven.model->criterion() == Criterion::kInBandError;
  out.text(is_in_band ? ", \"criterion\": \"band\"},\n" : "},\n");
  out.text(" \"signal\": {\"T\": ").exact(proven.signal->duration_s());
  out.text(", \"a\": ").exact(proven.limit_mps2).text("},\n");
  out.text(" \"energy\": {\"E\": ").exact(proven.energy_v2s).text(", \"switch_times\": [");
  const Span<const double> times_s = proven.signal->times_s();
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    out.text(i == 0 ? "" : ", ").exact(times_s[i]);
  }
  out.text("]},\n \"bound\": ").exact(proven.bound_v2s()).text(",\n");
}

void write_grid(const CertificateGrid& grid, TextWriter& out) noexcept {
  write_list("edges", Span<const double>(grid.edges_s).first(grid.cells + 1), out);
  write_list("switch_cost", Span<const double>(grid.switch_cost).first(grid.cells), out);
  out.text(" \"run_end\": [");
  for (std::size_t i = 0; i < grid.cells; ++i) {
    out.text(i == 0 ? "" : ", ").integer(grid.run_end[i]);
  }
  out.text("],\n \"free_from\": ").integer(grid.free_from);
  out.text(",\n \"constant\": ").exact(grid.constant).text(",\n");
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
    out.text(",").integer(multiplier.is_free ? kFreeKind : multiplier.kind).text(",");
    write_signed(multiplier.units, out);
    out.text("]");
    separator = ",\n  ";
  }
  out.text("],\n");
}

void write_node(const EnergyCertificate& certificate, const CertificateNode& node,
                TextWriter& out) noexcept {
  switch (node.kind) {
    case CertificateNode::Kind::kEmpty:
      out.text("{}");
      return;
    case CertificateNode::Kind::kSplit:
      out.text("{\"cell\": ").integer(node.cell);
      out.text(", \"plus\": ").integer(node.children[0]);
      out.text(", \"minus\": ").integer(node.children[1]).text("}");
      return;
    case CertificateNode::Kind::kLeaf:
      break;
  }
  out.text("{\"y\": [");
  const Span<const std::int32_t> duals = certificate.duals(node.leaf);
  for (std::size_t i = 0; i < duals.size(); ++i) {
    out.text(i == 0 ? "" : ",");
    write_signed(duals[i], out);
  }
  out.text("]}");
}

}  // namespace

void write_certificate(const ProvenEnergy& proven, TextWriter& out) noexcept {
  const EnergyCertificate& certificate = *proven.certificate;
  out.text("{\n");
  write_about(proven, out);
  write_grid(certificate.grid(), out);
  out.text(" \"unit\": ").exact(certificate.unit()).text(",\n");
  write_multipliers(certificate, out);
  out.text(" \"tree\": [");
  const char* separator = "\n  ";
  for (const CertificateNode& node : certificate.nodes()) {
    out.text(separator);
    write_node(certificate, node, out);
    separator = ",\n  ";
  }
  out.text("]\n}\n");
}

}  // namespace emax::desk
