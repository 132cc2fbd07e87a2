// Test image: the numeric self test on the target, with the check that failed.
#include <cstdint>

#include "emax/app/base/text_writer.hpp"
#include "emax/app/instrument/self_test.hpp"
#include "emax/base/status.hpp"
#include "emax/board/board.hpp"

#include "test_image.hpp"

namespace emax::board {
namespace {

constexpr int kFailed = 1;
constexpr int kFault = 3;

int run() noexcept {
  static app::SelfTestWorkspace memory;
  if (start_board() != Status::kOk) {
    return kFault;
  }
  ConsoleSink sink(ports().console);
  app::TextWriter out(sink);
  const app::SelfTestTables& tables = app::self_test_tables();
  const std::uint32_t failed = app::first_failed_check(tables, memory);
  if (failed == 0) {
    out.text("self test: ").integer(tables.size()).text(" checks passed\n");
    return 0;
  }
  out.text("self test: check ").integer(failed).text(" of ").integer(tables.size());
  out.text(" failed: ").text(name_of_check(tables, failed)).line();
  return kFailed;
}

}  // namespace
}  // namespace emax::board

extern "C" int main() { emax::board::finish(emax::board::run()); }
