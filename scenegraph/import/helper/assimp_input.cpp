#include "scenegraph/import/helper/assimp_input.h"

#include <assimp/MemoryIOWrapper.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <system_error>
#include <utility>

#include <simvis/location.h>
#include "engine/base/input_log.h"
#include "scenegraph/import/helper/obj_text.h"

namespace simvis {

AssimpInput::AssimpInput(AssimpFile& file) : file_(file), is_obj_(lower_case_ending(file.file) == ".obj") {}

Assimp::IOStream* AssimpInput::Open(const char* name, const char* mode) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(name, error)) {
    file_.warn("there is no material file " + in_quotes(name));
    return nullptr;
  }
  note_input(name);
  const std::optional<std::string>& prepared = file_.file == name ? file_.prepared : material_file(name);
  if (!prepared) return DefaultIOSystem::Open(name, mode);
  const std::string& text = *prepared;
  return new Assimp::MemoryIOStream(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
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
