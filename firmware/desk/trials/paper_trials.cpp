// Devices shared out to threads, and in each to the lanes of a vector.
#include "desk/trials/paper_trials.hpp"

#include <cstdint>
#include <limits>
#include <vector>

#include "emax/base/signs.hpp"
#include "emax/energy/fixed_point.hpp"
#include "emax/energy/phi_operator.hpp"

#include "desk/trials/paper_lanes.hpp"
#include "desk/trials/shares.hpp"

namespace emax::desk {
namespace {

void run_one_by_one(const ModalModel& at_estimate, const PaperProcedure& procedure,
                    Span<const Accelerometer> devices, Span<double> energies) {
  ModalModel model = at_estimate;
  std::vector<double> product(procedure.cells);
  std::vector<std::uint32_t> words(sign_words(procedure.cells));
  std::vector<std::uint32_t> best_words(words.size());
  const Signs signs(Span<std::uint32_t>(words.data(), words.size()), procedure.cells);
  const Signs best(Span<std::uint32_t>(best_words.data(), words.size()), procedure.cells);
  const Span<double> memory(product.data(), product.size());
  for (std::size_t i = 0; i < devices.size(); ++i) {
    PhiOperator phi;
    if (model.set_device(devices[i]) != Status::kOk ||
        phi.set(model, procedure.duration_s, procedure.cells) != Status::kOk) {
      energies[i] = std::numeric_limits<double>::quiet_NaN();
      continue;
    }
    signs_of_column(phi, 0, signs, memory);
    energies[i] =
        run_fixed_point(phi, procedure.max_iterations, 0.0, signs, best, memory, Span<double>())
            .energy;
  }
}

void run_share(const ModalModel& model, const PaperProcedure& procedure,
               Span<const Accelerometer> devices, Span<double> energies) {
  if (has_lanes()) {
    PaperLanes(model, procedure.duration_s, procedure.cells, procedure.max_iterations)
        .run(devices, energies);
    return;
  }
  run_one_by_one(model, procedure, devices, energies);
}

}  // namespace

void find_paper_energies(const ModalModel& model, const PaperProcedure& procedure,
                         std::size_t threads, Span<const Accelerometer> devices,
                         Span<double> energies) {
  share_out(threads, devices.size(), [&](const Share& share) {
    run_share(model, procedure, devices.from(share.begin).first(share.size),
              energies.from(share.begin).first(share.size));
  });
}

}  // namespace emax::desk
