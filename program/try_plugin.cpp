// The main() of the program simvis-try-plugin, which SimVis starts before it loads a plug-in:
//   simvis-try-plugin FILE...
// It loads the libraries in their order. The loader cannot pass on an exception of a static initialiser, so such a
// library ends this program instead of the one that asked. The reason, if there is one, is written to the file
// descriptor kAnswerDescriptor.
#include <dlfcn.h>
#include <unistd.h>

#include <cstring>
#include <exception>
#include <span>

#include <simvis/version.h>
#include "import/sandbox/sandbox_process.h"

namespace {

void answer(const char* text) {
  [[maybe_unused]] const ssize_t written = ::write(simvis::kAnswerDescriptor, text, std::strlen(text));
}

[[noreturn]] void end_with_reason() {
  try {
    if (const std::exception_ptr thrown = std::current_exception()) std::rethrow_exception(thrown);
    answer("std::terminate() was called");
  } catch (const std::exception& error) {
    answer(error.what());
  } catch (...) {
    answer("an object that is not a std::exception");
  }
  ::_exit(1);
}

}  // namespace

int main(int count, char** arguments) {
  std::set_terminate(end_with_reason);
  simvis::version();  // plug-ins register with the library, so it has to be there
  for (const char* const file : std::span(arguments, static_cast<std::size_t>(count)).subspan(1)) {
    // What the loader itself refuses is reported by the program that asked.
    if (::dlopen(file, RTLD_NOW | RTLD_LOCAL) == nullptr) break;
  }
  ::_exit(0);  // skips the libraries' cleanup
}
