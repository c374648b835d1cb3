// The binary interface of libsimvis-client.so: programs that were compiled with an earlier release of the same minor
// version run with it. exchange/clients/client_abi.txt holds the declarations of its functions and the sizes of its
// structures.
#include <doctest/doctest.h>

#include <simvis_client/client.h>

#include <cctype>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>

#include "tests/support/run_process.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("clients");

namespace simvis {
namespace {

std::string one_line(std::string text) {
  text = std::regex_replace(text, std::regex("\\s+"), " ");
  return text.substr(text.find_first_not_of(' '));
}

/// Declarations of functions in the header, by name.
std::map<std::string, std::string> declarations() {
  std::string text = read_text(std::filesystem::path(SIMVIS_SOURCE_DIR) / "include/simvis_client/client.h");
  text = std::regex_replace(text, std::regex("/\\*[^*]*\\*+([^/*][^*]*\\*+)*/|(^|\n)#[^\n]*|extern \"C\" \\{"), "\n");
  std::map<std::string, std::string> found;
  const std::regex declaration("[^;{}]*\\b(simvis_\\w+)\\([^;{}]*\\);");
  for (std::sregex_iterator each(text.begin(), text.end(), declaration), end; each != end; ++each) {
    found[(*each)[1]] = one_line(each->str());
  }
  return found;
}

std::set<std::string> exported_names() {
  const ProcessResult nm = Process({"nm", "-D", "--defined-only", tested_build() + "/lib/libsimvis-client.so"}).wait();
  REQUIRE(nm.exit_code == 0);
  std::set<std::string> names;
  std::istringstream lines(nm.out);
  for (std::string address, kind, name; lines >> address >> kind >> name;) {
    if (name.starts_with("simvis_")) names.insert(name);  // sanitizers add names of their own
  }
  return names;
}

TEST_CASE("the binary interface of the client library is the one of its version") {
  const std::map<std::string, std::string> declared = declarations();
  std::ostringstream interface;
  interface << "layout of the shared memory: version " << SIMVIS_SHM_VERSION << '\n';
  for (const std::string& name : exported_names()) {
    REQUIRE_MESSAGE(declared.contains(name), name, " is exported without a declaration");
    interface << declared.at(name) << '\n';
  }
  interface << "struct simvis_frame_info: " << sizeof(simvis_frame_info) << " bytes\n"
            << "struct simvis_view: " << sizeof(simvis_view) << " bytes\n"
            << "struct simvis_text: " << sizeof(simvis_text) << " bytes\n"
            << "struct simvis_element: " << sizeof(simvis_element) << " bytes\n"
            << "struct simvis_parameter: " << sizeof(simvis_parameter) << " bytes\n"
            << "struct simvis_sensor: " << sizeof(simvis_sensor) << " bytes\n"
            << "struct simvis_output: " << sizeof(simvis_output) << " bytes\n"
            << "struct simvis_log_entry: " << sizeof(simvis_log_entry) << " bytes\n";
  const std::string expected = read_text(std::filesystem::path(SIMVIS_SOURCE_DIR) / "exchange/clients/client_abi.txt");
  INFO("a change of what is there needs a new minor version (docs/versions.md) and a new client_abi.txt");
  CHECK(interface.str() == expected);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
