// A page of the live view without a browser. It has the scene and shows the scanner of the wall's scene.
#pragma once

#include <doctest/doctest.h>

#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/live/web_client.h"

namespace simvis::test {

inline constexpr const char* kView = "simvis.live.v1";

inline std::size_t index_of(const nlohmann::json& list, const std::string& key, const std::string& value,
                            const std::string& name = "") {
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (list[i].is_null() || list[i].at(key) != value) continue;
    if (name.empty() || list[i].at("name") == name) return i;
  }
  FAIL("there is no ", value);
  return 0;
}

/// One page. It has the scene and shows the scanner.
struct Page {
  explicit Page(std::uint16_t port) : socket(port, kView), scene(socket.receive_op("scene")) {
    scanner = index_of(scene.at("sensors"), "name", "SCAN");
    move_x = index_of(scene.at("parameters"), "element", "MOVE", "x");
    socket.send({{"op", "look"}, {"sensors", {scanner}}});
  }
  /// The range of the middle beam in the next scan for which fits(range).
  template <typename Predicate>
  float range(const Predicate& fits) {
    float range = 0;
    socket.receive_binary([&](const std::string& bytes) {
      constexpr std::size_t kSize = 8 + 8 + 12 * sizeof(double) + 2 * sizeof(std::uint32_t);
      if (bytes[0] != 2) return false;
      std::uint32_t described = 0;  // bytes that say what the columns are
      std::memcpy(&described, bytes.data() + kSize, sizeof described);
      std::memcpy(&range, bytes.data() + kSize + 8 + described + 2 * sizeof(float), sizeof range);
      return fits(range);
    });
    return range;
  }
  nlohmann::json frame() { return socket.receive_op("frame"); }

  WebSocketClient socket;
  nlohmann::json scene;
  std::size_t scanner = 0, move_x = 0;
};

}  // namespace simvis::test
