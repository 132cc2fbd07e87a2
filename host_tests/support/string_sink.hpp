// A sink that keeps what is written, and the text of one call.
#pragma once

#include <string>

#include "emax/app/base/text_writer.hpp"

namespace emax::test {

class StringSink final : public emax::app::TextSink {
 public:
  void write(emax::Span<const char> text) noexcept override {
    text_.append(text.data(), text.size());
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

/// @returns What `write` writes into the TextWriter that it is given.
template <typename Write>
std::string text_of(const Write& write) {
  StringSink sink;
  emax::app::TextWriter out(sink);
  write(out);
  return sink.text();
}

}  // namespace emax::test
