// The files of the PC program's code in a browser.
#include "page_files.hpp"

#include <cstddef>
#include <utility>
#include <vector>

#include "desk/cli/console.hpp"
#include "desk/cli/stop_request.hpp"
#include "desk/files/text_file.hpp"

namespace emax::web {
namespace {

struct File {
  std::string name;
  std::string_view text;
};

// In the arena, so it is made anew by each call.
std::vector<File>* files = nullptr;

}  // namespace

void forget_files() noexcept { files = new std::vector<File>(); }

void add_file(std::string name, std::string_view text) {
  files->push_back({std::move(name), text});
}

}  // namespace emax::web

namespace emax::desk {

bool stop_requested() noexcept { return false; }

std::string name_of_input(const std::string& path) { return printable(path); }

Problem read_text_file(const std::string& path, std::size_t most, const char* expectation,
                       std::string& text) {
  for (const web::File& file : *web::files) {
    if (file.name != path) {
      continue;
    }
    if (file.text.size() > most) {
      return bad_input(name_of_input(path) + ": larger than " + std::to_string(most >> 20) +
                       " MiB; " + expectation);
    }
    text = file.text;
    return {};
  }
  return bad_input(name_of_input(path) + ": no such file; " + expectation);
}

}  // namespace emax::desk
