#include "import/usd/usd_answer.h"

#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include <simvis/error.h>
#include "engine/base/binary_numbers.h"
#include "engine/base/input_file.h"
#include "import/gltf/gltf_importer.h"
#include "import/usd/usd_model.h"

namespace simvis {
namespace {

// The JSON, whose text is behind its size in eight bytes, and the bytes behind it.
using UsdAnswer = std::pair<nlohmann::json, Bytes>;

UsdAnswer split_answer(std::span<const std::uint8_t> answer, const std::filesystem::path& file) {
  const auto fail = [&] {
    throw InputError(file.string() + ": error: the helper program that read it returned a malformed answer");
  };
  if (answer.size() < sizeof(std::uint64_t)) fail();
  const auto size = binary_at<std::uint64_t>(answer, 0);
  const auto rest = answer.subspan(sizeof(size));
  if (size > rest.size()) fail();
  constexpr int kMaxDepth = 64;  // dump() calls itself for each level
  bool is_deep = false;
  const auto note_depth = [&](int depth, nlohmann::json::parse_event_t, const nlohmann::json&) {
    is_deep = is_deep || depth > kMaxDepth;
    return !is_deep;
  };
  nlohmann::json json =
      nlohmann::json::parse(rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(size), note_depth, false);
  if (is_deep || !json.is_object() || !json.contains("gltf") || !json.contains("model")) fail();
  Bytes binary(rest.begin() + static_cast<std::ptrdiff_t>(size), rest.end());
  return {std::move(json), std::move(binary)};
}

}  // namespace

PartContent read_usd_answer(std::span<const std::uint8_t> answer, const std::filesystem::path& file, bool y_up,
                            ContentPool& pool) {
  auto [json, binary] = split_answer(answer, file);
  GltfDocument document = read_converted_gltf(file, json["gltf"].dump(), std::move(binary));
  PartContent content = build_gltf(document, pool, y_up);
  if (!json["model"].is_null()) {
    content.model = std::make_shared<UsdSource>(read_usd_model(json["model"], document, pool));
  }
  return content;
}

}  // namespace simvis
