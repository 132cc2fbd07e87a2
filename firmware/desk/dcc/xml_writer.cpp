// XML, an element a line.
#include "desk/dcc/xml_writer.hpp"

#include "emax/app/base/utf8.hpp"

namespace emax::desk {

namespace {

void append_character(std::string& xml, const char* text, const app::Character& next) {
  switch (next.code) {
    case '&':
      xml += "&amp;";
      break;
    case '<':
      xml += "&lt;";
      break;
    case '>':
      xml += "&gt;";
      break;
    case '"':
      xml += "&quot;";
      break;
    case app::kReplacement:
      xml += "\xEF\xBF\xBD";
      break;
    default:
      xml.append(text, next.length);
  }
}

}  // namespace

std::string xml_text(const char* text) {
  std::string xml;
  bool is_after_blank = false;
  while (*text != '\0') {
    const app::Character next = app::first_character(text);
    const bool is_blank = next.code == ' ' || next.code == '\n' || next.code == '\t' ||
                          next.code == '\r' || !app::is_printable(next.code);
    if (!is_blank) {
      xml += is_after_blank && !xml.empty() ? " " : "";
      append_character(xml, text, next);
    }
    is_after_blank = is_blank;
    text += next.length;
  }
  return xml;
}

XmlWriter& XmlWriter::open(const char* name, std::string_view attributes) {
  indent();
  xml_ += std::string("<") + name;
  xml_ += attributes.empty() ? "" : " ";
  xml_.append(attributes).append(">\n");
  open_.push_back(name);
  return *this;
}

XmlWriter& XmlWriter::close() {
  const char* const name = open_.back();
  open_.pop_back();
  indent();
  xml_ += std::string("</") + name + ">\n";
  return *this;
}

XmlWriter& XmlWriter::element(const char* name, const std::string& content,
                              std::string_view attributes) {
  indent();
  xml_ += std::string("<") + name;
  xml_ += attributes.empty() ? "" : " ";
  xml_.append(attributes).append(">").append(content).append("</").append(name).append(">\n");
  return *this;
}

}  // namespace emax::desk
