// What a warning says.
#include "desk/report/warning_words.hpp"

#include "emax/app/base/text_writer.hpp"

#include "desk/cli/console.hpp"
#include "desk/files/rounding.hpp"

namespace emax::desk {

std::string sentence_of(const std::string& words, double least_time_s) {
  if (!(least_time_s > 0.0)) {
    return words;
  }
  constexpr double kMilli = 1e3;
  constexpr int kDigits = 3;
  StringSink sink;
  app::TextWriter out(sink);
  out.text(words.c_str()).text(", ");
  out.general(rounded_up(kMilli * least_time_s, kDigits - 1), kDigits).text(" ms");
  return sink.text();
}

}  // namespace emax::desk
