// XML, an element a line.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace emax::desk {

/// Text of others for XML: markup is escaped, what no line can hold is a blank or U+FFFD, blanks at
/// the ends are gone and runs of them one.
std::string xml_text(const char* text);

class XmlWriter final {
 public:
  XmlWriter() : xml_("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n") {}

  /// Opens an element; `attributes` as they stand behind its name.
  XmlWriter& open(const char* name, std::string_view attributes = {});
  /// Closes the last one that is open.
  XmlWriter& close();
  /// A whole element.
  ///
  /// @param[in] content As XML.
  XmlWriter& element(const char* name, const std::string& content,
                     std::string_view attributes = {});
  const std::string& text() const noexcept { return xml_; }

 private:
  void indent() { xml_.append(2 * open_.size(), ' '); }

  std::string xml_;
  std::vector<const char*> open_;
};

}  // namespace emax::desk
