// The file that proves a bound, for whoever wants to check it.
#pragma once

#include "emax/app/base/text_writer.hpp"
#include "emax/bound/energy_certificate.hpp"
#include "emax/energy/switching_signal.hpp"
#include "emax/model/modal_model.hpp"

#include "desk/certify/box_proof.hpp"

namespace emax::desk {

/// A bound with the signal that comes closest to it.
struct ProvenEnergy {
  const BoxProof* box = nullptr;  ///< If all devices of a box are meant.
  const ModalModel* model = nullptr;
  const EnergyCertificate* certificate = nullptr;
  const SwitchingSignal* signal = nullptr;
  double limit_mps2 = 0.0;
  double energy_v2s = 0.0;  ///< Reached by the signal.

  double bound_v2s() const {
    return limit_mps2 * limit_mps2 * (box != nullptr ? box->bound() : certificate->bound());
  }
};

/// Writes the certificate as JSON: all that `host_tests/reference/check_certificate.py` reads.
/// Costs, curvature terms and unit are for a = 1; a multiplier is [i, j, k, kind, units], and y is
/// in units: one list, or for a box a list of them, one for each corner.
void write_certificate(const ProvenEnergy& proven, app::TextWriter& out);

}  // namespace emax::desk
