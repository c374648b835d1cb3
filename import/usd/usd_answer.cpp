#include "import/usd/usd_answer.h"

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include <simvis/error.h>
#include "engine/base/binary_numbers.h"
#include "engine/base/input_file.h"
#include "import/gltf/gltf_importer.h"
#include "import/model/shown_visuals.h"
#include "import/usd/usd_model.h"

namespace simvis {
namespace {

// The JSON, whose text is behind its size in eight bytes, and the bytes behind it.
using UsdAnswer = std::pair<nlohmann::json, Bytes>;

[[noreturn]] void fail_malformed(const std::filesystem::path& file) {
  throw InputError(file.string() + ": error: the helper program that read it returned a malformed answer");
}

UsdAnswer split_answer(std::span<const std::uint8_t> answer, const std::filesystem::path& file) {
  const auto fail = [&] { fail_malformed(file); };
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
  const auto has = [&](const char* name) { return json.contains(name); };
  if (is_deep || !json.is_object() || !has("gltf") || !has("model") || !has("visuals")) fail();
  Bytes binary(rest.begin() + static_cast<std::ptrdiff_t>(size), rest.end());
  return {std::move(json), std::move(binary)};
}

// What is not shown of a stage.
class UsdVisuals {
 public:
  UsdVisuals(const nlohmann::json& written, const ImportRequest& request) : file_(request.file), shown_(request) {
    shown_.show(count(written, "shown"));
    for (const std::filesystem::path& layer : paths(written, "layers_outside")) shown_.leave_out_outside(layer);
    const auto reason = written.find("reason");
    if (reason == written.end() || !reason->is_string()) fail_malformed(file_);
    if (const std::size_t missing = count(written, "missing"); missing > 0) {
      shown_.leave_out(file_.string() + ": " + reason->get<std::string>(), missing);
    }
    pictures_ = paths(written, "pictures_outside");
  }

  std::vector<std::string> warnings() const {
    std::vector<std::string> given;
    for (auto& warning : {shown_.outside_warning(), outside_warning(file_, "picture", pictures_)}) {
      if (warning) given.push_back(*warning);
    }
    return given;
  }

  void require() const { shown_.require(true); }

 private:
  std::size_t count(const nlohmann::json& written, const char* name) const {
    const auto found = written.find(name);
    if (found == written.end() || !found->is_number_unsigned()) fail_malformed(file_);
    return found->get<std::uint32_t>();
  }

  std::vector<std::filesystem::path> paths(const nlohmann::json& written, const char* name) const {
    const auto found = written.find(name);
    if (found == written.end() || !found->is_array()) fail_malformed(file_);
    std::vector<std::filesystem::path> read;
    for (const nlohmann::json& each : *found) {
      if (!each.is_string() || !each.get_ref<const std::string&>().starts_with('/')) fail_malformed(file_);
      read.emplace_back(each.get<std::string>());
    }
    return read;
  }

  std::filesystem::path file_;
  ShownVisuals shown_;
  std::vector<std::filesystem::path> pictures_;
};

}  // namespace

PartContent read_usd_answer(std::span<const std::uint8_t> answer, const ImportRequest& request, ContentPool& pool) {
  const std::filesystem::path& file = request.file;
  auto [json, binary] = split_answer(answer, file);
  const UsdVisuals visuals(json["visuals"], request);
  visuals.require();
  GltfDocument document = read_converted_gltf(file, json["gltf"].dump(), std::move(binary));
  PartContent content = build_gltf(document, pool, request.up_given && request.up == UpAxis::y);
  const std::vector<std::string> warnings = visuals.warnings();
  content.warnings.insert(content.warnings.begin(), warnings.begin(), warnings.end());
  if (!json["model"].is_null()) {
    content.model = std::make_shared<UsdSource>(read_usd_model(json["model"], document, pool));
  }
  return content;
}

}  // namespace simvis
