// What tools/cmake/hardening.cmake asks for is in the programs and libraries of a release, as their ELF headers say.
#include <doctest/doctest.h>
#include <elf.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/skip.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("sources");

namespace simvis {
namespace {

namespace fs = std::filesystem;

/// A file of 64 bits, with the byte order of this machine.
class ElfFile {
 public:
  explicit ElfFile(const fs::path& file) : bytes_(read_text(file)), header_(at<Elf64_Ehdr>(0)) {
    REQUIRE(std::memcmp(header_.e_ident, ELFMAG, SELFMAG) == 0);
    for (int i = 0; i < header_.e_phnum; ++i) {
      segments_.push_back(at<Elf64_Phdr>(header_.e_phoff + static_cast<std::size_t>(i) * header_.e_phentsize));
    }
    for (int i = 0; i < header_.e_shnum; ++i) {
      sections_.push_back(at<Elf64_Shdr>(header_.e_shoff + static_cast<std::size_t>(i) * header_.e_shentsize));
    }
  }

  const Elf64_Ehdr& header() const { return header_; }
  const Elf64_Phdr* segment(Elf64_Word type) const {
    const auto found =
        std::find_if(segments_.begin(), segments_.end(), [&](const auto& s) { return s.p_type == type; });
    return found == segments_.end() ? nullptr : &*found;
  }
  /// The value of an entry of the dynamic section; 0: it is not there.
  Elf64_Xword dynamic(Elf64_Sxword tag) const {
    const Elf64_Phdr* const dynamic = segment(PT_DYNAMIC);
    REQUIRE(dynamic != nullptr);
    for (std::size_t i = 0; i < dynamic->p_filesz; i += sizeof(Elf64_Dyn)) {
      const auto entry = at<Elf64_Dyn>(dynamic->p_offset + i);
      if (entry.d_tag == tag) return entry.d_un.d_val;
    }
    return 0;
  }

  struct Symbol {
    std::string name;
    bool is_defined = false, is_function = false;
    std::size_t offset = 0;  // of its code in the file
  };
  std::vector<Symbol> dynamic_symbols() const {
    std::vector<Symbol> symbols;
    for (const Elf64_Shdr& section : sections_) {
      if (section.sh_type != SHT_DYNSYM) continue;
      const Elf64_Shdr& names = sections_.at(section.sh_link);
      for (std::size_t i = 0; i < section.sh_size; i += sizeof(Elf64_Sym)) {
        const auto symbol = at<Elf64_Sym>(section.sh_offset + i);
        symbols.push_back({.name = &bytes_.at(names.sh_offset + symbol.st_name),
                           .is_defined = symbol.st_shndx != SHN_UNDEF,
                           .is_function = ELF64_ST_TYPE(symbol.st_info) == STT_FUNC,
                           .offset = offset_of(symbol.st_value)});
      }
    }
    return symbols;
  }
  std::string bytes(std::size_t offset, std::size_t count) const { return bytes_.substr(offset, count); }

 private:
  template <class T>
  T at(std::size_t offset) const {
    T value{};
    REQUIRE(offset + sizeof value <= bytes_.size());
    std::memcpy(&value, bytes_.data() + offset, sizeof value);
    return value;
  }
  std::size_t offset_of(Elf64_Addr address) const {
    for (const Elf64_Phdr& segment : segments_) {
      const bool is_in = segment.p_type == PT_LOAD && address >= segment.p_vaddr;
      if (is_in && address < segment.p_vaddr + segment.p_filesz) return segment.p_offset + address - segment.p_vaddr;
    }
    return 0;
  }

  std::string bytes_;
  Elf64_Ehdr header_;
  std::vector<Elf64_Phdr> segments_;
  std::vector<Elf64_Shdr> sections_;
};

bool is_release() {
  return read_text(tested_build() + "/CMakeCache.txt").find("CMAKE_BUILD_TYPE:STRING=Release") != std::string::npos;
}

std::vector<fs::path> built_files() {
  const fs::path build = tested_build();
  std::vector<fs::path> files{build / "bin/simvis-run", build / "bin/simvis-ctl", build / "lib/libsimvis.so",
                              build / "lib/libsimvis-client.so", build / "lib/libsimvis-testing.so"};
  for (const fs::directory_entry& file : fs::directory_iterator(build / "lib/simvis")) {
    if (file.path().filename().string().starts_with("simvis-")) files.push_back(file.path());
  }
  return files;
}

std::size_t count_of_chk(const ElfFile& file) {
  const auto symbols = file.dynamic_symbols();
  return static_cast<std::size_t>(std::count_if(symbols.begin(), symbols.end(), [](const ElfFile::Symbol& symbol) {
    return symbol.name.starts_with("__") && symbol.name.ends_with("_chk");
  }));
}

TEST_CASE("every program and library of a release lies at no fixed place, and nothing can write to its tables") {
  if (!is_release()) return test::skip("only releases are hardened");
  const std::vector<fs::path> files = built_files();
  CHECK(files.size() >= 7);
  for (const fs::path& path : files) {
    CAPTURE(path);
    const ElfFile file(path);
    const bool is_library = path.string().find(".so") != std::string::npos;
    CHECK(file.header().e_type == ET_DYN);
    CHECK((file.segment(PT_INTERP) != nullptr) == !is_library);
    if (!is_library) CHECK((file.dynamic(DT_FLAGS_1) & DF_1_PIE) != 0);
    CHECK(file.segment(PT_GNU_RELRO) != nullptr);
    CHECK((file.dynamic(DT_FLAGS_1) & DF_1_NOW) != 0);
    REQUIRE(file.segment(PT_GNU_STACK) != nullptr);
    CHECK((file.segment(PT_GNU_STACK)->p_flags & PF_X) == 0);
  }
}

TEST_CASE("the library and the programs have canaries on the stack and checked calls") {
  if (!is_release()) return test::skip("only releases are hardened");
  const fs::path build = tested_build();
  for (const char* name :
       {"lib/libsimvis.so", "bin/simvis-run", "lib/simvis/simvis-import-mesh", "lib/simvis/simvis-decode"}) {
    CAPTURE(std::string(name));
    const ElfFile file(build / name);
    const auto symbols = file.dynamic_symbols();
    CHECK(std::any_of(symbols.begin(), symbols.end(),
                      [](const ElfFile::Symbol& symbol) { return symbol.name == "__stack_chk_fail"; }));
    CHECK(count_of_chk(file) >= 1);
  }
}

// A file as a whole is marked for CET where the C library's start files are, which those of Debian 12 are not.
TEST_CASE("functions of the library begin with a mark for indirect jumps") {
  const ElfFile file(fs::path(tested_build()) / "lib/libsimvis.so");
  if (!is_release()) return test::skip("only releases are hardened");
  if (file.header().e_machine != EM_X86_64) return test::skip("the processor has no shadow stack");
  const std::string kEndbr64 = "\xf3\x0f\x1e\xfa";
  int functions = 0;
  for (const ElfFile::Symbol& symbol : file.dynamic_symbols()) {
    if (!symbol.is_defined || !symbol.is_function || symbol.name.find("simvis") == std::string::npos) continue;
    CAPTURE(symbol.name);
    CHECK(file.bytes(symbol.offset, 4) == kEndbr64);
    ++functions;
  }
  CHECK(functions > 100);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
