// What a certificate names beyond the labels of every instrument.
#include "desk/cli/label_rows.hpp"

#include <string_view>

namespace emax::desk {

const char* label_of(const app::Labels& labels, CertificateLabel label) noexcept {
  const std::string_view key = kLabelRows[static_cast<std::size_t>(label)].key;
  for (const app::NamedLabel& one : labels.more) {
    if (key == one.key) {
      return one.words;
    }
  }
  return nullptr;
}

}  // namespace emax::desk
