// Which libraries a program gets with libsimvis.so.
#include <doctest/doctest.h>
#include <link.h>

#include <algorithm>
#include <string>
#include <vector>

#include <simvis/version.h>

TEST_SUITE_BEGIN("public");

namespace simvis {

TEST_CASE("the library brings neither Assimp, Coin, Bullet nor OpenEXR into the programs that use it") {
  CHECK_FALSE(version().empty());  // which needs the library
  std::vector<std::string> loaded;
  ::dl_iterate_phdr(
      [](dl_phdr_info* library, std::size_t, void* names) {
        static_cast<std::vector<std::string>*>(names)->emplace_back(library->dlpi_name);
        return 0;
      },
      &loaded);
  const auto has = [&](const char* part) {
    return std::any_of(loaded.begin(), loaded.end(),
                       [&](const std::string& name) { return name.find(part) != std::string::npos; });
  };
  CHECK(has("libsimvis"));
  CHECK_FALSE(has("libassimp"));
  CHECK_FALSE(has("libCoin"));
  CHECK_FALSE(has("Bullet"));
  CHECK_FALSE(has("OpenEXR"));
}

}  // namespace simvis

TEST_SUITE_END();
