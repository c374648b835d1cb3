// Whether what a run left behind is whole: a fault of the machine leaves no file half-written.
#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/picture_files.h"
#include "tests/support/temporary_folder.h"

namespace simvis {

/// What is wrong with the file; empty: it is whole, or of a kind that cannot show it.
inline std::string fault_of_file(const std::filesystem::path& file) {
  const std::string name = file.filename().string(), ending = file.extension().string();
  if (name.starts_with('.') && ending == ".tmp") return "a temporary file is left";
  if (ending == ".simvis-lock") return "a lock is left";
  if (ending == ".png" || ending == ".exr") {
    try {
      return (ending == ".png" ? read_png(file).width > 0 : read_exr(file).width > 0) ? "" : "it is empty";
    } catch (const std::exception& error) {
      return error.what();
    }
  }
  const std::string text = read_text(file);
  if ((ending == ".csv" || ending == ".tum" || ending == ".yaml") && !text.ends_with('\n')) return "a line is cut off";
  if (ending == ".json" && !nlohmann::json::accept(text)) return "it is no JSON";
  if (ending == ".html" && text.find("</html>") == text.npos) return "the page has no end";
  if (ending == ".mcap" && !text.ends_with("\x89MCAP0\r\n")) return "the recording has no end";
  if (ending == ".glb") {
    std::uint32_t size = 0;
    if (text.size() >= 12) std::memcpy(&size, text.data() + 8, sizeof size);
    if (size != text.size()) return "it is shorter or longer than its header says";
  }
  return "";
}

/// "FILE: WHAT" for the first file below the folder that is not whole; empty: all are.
inline std::string first_fault_below(const std::filesystem::path& folder) {
  for (const std::string& name : files_below(folder)) {
    const std::string fault = fault_of_file(folder / name);
    if (!fault.empty()) return name + ": " + fault;
  }
  return "";
}

}  // namespace simvis
