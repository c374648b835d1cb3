#include "import/programs/assimp_input.h"

#include <assimp/MemoryIOWrapper.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <span>
#include <utility>

#include <simvis/location.h>
#include "engine/base/input_file.h"
#include "engine/base/read_error.h"
#include "engine/base/read_fence.h"
#include "import/programs/obj_text.h"

namespace simvis {
namespace {

// A file that is read while Assimp asks for it.
class CheckedStream : public Assimp::IOStream {
 public:
  CheckedStream(const char* name, std::exception_ptr& fault) : file_(name), fault_(fault) {}

  size_t Read(void* bytes, size_t size, size_t count) override try {
    if (size == 0) return 0;
    const std::size_t got = file_.read_into({static_cast<std::uint8_t*>(bytes), size * count}, at_);
    at_ += got;
    return got / size;
  } catch (...) {
    if (!fault_) fault_ = std::current_exception();
    return 0;
  }
  size_t Write(const void*, size_t, size_t) override { return 0; }
  aiReturn Seek(size_t offset, aiOrigin origin) override {
    const std::size_t from = origin == aiOrigin_CUR ? at_ : origin == aiOrigin_END ? file_.size() : 0;
    at_ = from + offset;
    return aiReturn_SUCCESS;
  }
  size_t Tell() const override { return at_; }
  size_t FileSize() const override { return file_.size(); }
  void Flush() override {}

 private:
  InputFile file_;
  std::exception_ptr& fault_;
  std::size_t at_ = 0;
};

}  // namespace

AssimpInput::AssimpInput(AssimpFile& file) : file_(file), is_obj_(lower_case_ending(file.file) == ".obj") {}

bool AssimpInput::Exists(const char* name) const try { return is_input_file(name); } catch (...) {
  if (!fault_) fault_ = std::current_exception();
  return false;
}

Assimp::IOStream* AssimpInput::Open(const char* name, const char*) try {
  if (!is_readable(name)) {
    file_.warn("the material file " + in_quotes(name) + " is outside the folders of the part and is not read");
    return nullptr;
  }
  if (!is_input_file(name)) {
    file_.warn("there is no material file " + in_quotes(name));
    return nullptr;
  }
  const bool is_own = file_.file == name;
  const std::optional<std::string>& prepared = is_own ? file_.prepared : material_file(name);
  if (!prepared) return new CheckedStream(name, fault_);
  const std::string& text = *prepared;
  return new Assimp::MemoryIOStream(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
} catch (...) {
  if (!fault_) fault_ = std::current_exception();
  return nullptr;
}

void AssimpInput::rethrow_fault() const {
  if (fault_) std::rethrow_exception(fault_);
}

const std::optional<std::string>& AssimpInput::material_file(const char* name) {
  const auto [known, is_new] = material_files_.try_emplace(name);
  if (is_new && is_obj_) {
    known->second = prepared_mtl(name, file_);
  }
  return known->second;
}

std::string lower_case_ending(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::ranges::transform(ending, ending.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return ending;
}

}  // namespace simvis
