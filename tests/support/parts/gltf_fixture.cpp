#include "tests/support/parts/gltf_fixture.h"

#include <utility>

namespace simvis::test {

void write_bytes(const std::filesystem::path& file, const ByteString& bytes) {
  write_text(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

std::string base64(const ByteString& bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) bits = bits << 8 | (i + k < bytes.size() ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) {
      text.push_back(i + k > bytes.size() ? '=' : kDigits[bits >> (18 - 6 * k) & 63]);
    }
  }
  return text;
}

void put_u32(ByteString& bytes, std::uint32_t value, bool big_endian) {
  for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<std::uint8_t>(value >> (big_endian ? 24 - 8 * i : 8 * i)));
}

ByteString png(std::uint32_t width, std::uint32_t height, int bit_depth, int color_type,
               const std::vector<ByteString>& rows) {
  ByteString raw;
  for (const ByteString& row : rows) {
    raw.push_back(0);  // no filter
    raw.insert(raw.end(), row.begin(), row.end());
  }
  ByteString header;
  put_u32(header, width, true);
  put_u32(header, height, true);
  header.insert(header.end(), {static_cast<std::uint8_t>(bit_depth), static_cast<std::uint8_t>(color_type), 0, 0, 0});
  const auto size = static_cast<std::uint16_t>(raw.size());
  ByteString data{0x78,
                  0x01,
                  0x01,
                  static_cast<std::uint8_t>(size & 255),
                  static_cast<std::uint8_t>(size >> 8),
                  static_cast<std::uint8_t>(~size & 255),
                  static_cast<std::uint8_t>(static_cast<std::uint16_t>(~size) >> 8)};
  std::uint32_t a = 1, b = 0;
  for (const std::uint8_t byte : raw) {
    data.push_back(byte);
    a = (a + byte) % 65521;
    b = (b + a) % 65521;
  }
  put_u32(data, b << 16 | a, true);
  ByteString file{0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
  const auto chunk = [&file](std::string_view type, const ByteString& content) {
    put_u32(file, static_cast<std::uint32_t>(content.size()), true);
    const std::size_t start = file.size();
    file.insert(file.end(), type.begin(), type.end());
    file.insert(file.end(), content.begin(), content.end());
    std::uint32_t crc = ~0u;
    for (std::size_t i = start; i < file.size(); ++i) {
      crc ^= file[i];
      for (int k = 0; k < 8; ++k) crc = (crc >> 1) ^ ((crc & 1) != 0 ? 0xEDB88320u : 0u);
    }
    put_u32(file, ~crc, true);
  };
  chunk("IHDR", header);
  chunk("IDAT", data);
  chunk("IEND", {});
  return file;
}

GltfBuilder::GltfBuilder() { root["asset"]["version"] = "2.0"; }

int GltfBuilder::view(const void* data, std::size_t size) {
  while (bytes.size() % 4 != 0) bytes.push_back(0);
  const std::size_t offset = bytes.size();
  const auto* first = static_cast<const std::uint8_t*>(data);
  bytes.insert(bytes.end(), first, first + size);
  return append("bufferViews", {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", size}});
}

int GltfBuilder::accessor_of(int component, const char* type, const void* values, std::size_t count, std::size_t size,
                             bool normalized) {
  static constexpr std::pair<std::string_view, std::size_t> kSizes[] = {
      {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT4", 16}};
  std::size_t components = 1;
  for (const auto& [name, elements] : kSizes) components = name == type ? elements : components;
  json description{{"bufferView", view(values, count * size)},
                   {"componentType", component},
                   {"count", count / components},
                   {"type", type}};
  if (normalized) description["normalized"] = true;
  return append("accessors", std::move(description));
}

int GltfBuilder::append(const char* array, json value) {
  root[array].push_back(std::move(value));
  return static_cast<int>(root[array].size()) - 1;
}

json& GltfBuilder::primitive(json attributes) {
  const int mesh = append("meshes", {{"primitives", json::array({{{"attributes", std::move(attributes)}}})}});
  append("nodes", {{"mesh", mesh}});
  return root["meshes"].back()["primitives"][0];
}

json& GltfBuilder::triangle() {
  return primitive({{"POSITION", accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0})}});
}

std::string GltfBuilder::text() const {
  json document = root;
  if (!bytes.empty() && !document.contains("buffers")) {
    document["buffers"] = {
        {{"byteLength", bytes.size()}, {"uri", "data:application/octet-stream;base64," + base64(bytes)}}};
  }
  return document.dump();
}

ByteString GltfBuilder::glb() const {
  json document = root;
  ByteString binary = bytes;
  if (!binary.empty()) document["buffers"] = {{{"byteLength", binary.size()}}};
  std::string header = document.dump();
  while (header.size() % 4 != 0) header.push_back(' ');
  while (binary.size() % 4 != 0) binary.push_back(0);
  ByteString file{'g', 'l', 'T', 'F', 2, 0, 0, 0};
  put_u32(file, static_cast<std::uint32_t>(12 + 8 + header.size() + (binary.empty() ? 0 : 8 + binary.size())), false);
  put_u32(file, static_cast<std::uint32_t>(header.size()), false);
  file.insert(file.end(), {'J', 'S', 'O', 'N'});
  file.insert(file.end(), header.begin(), header.end());
  if (binary.empty()) return file;
  put_u32(file, static_cast<std::uint32_t>(binary.size()), false);
  file.insert(file.end(), {'B', 'I', 'N', 0});
  file.insert(file.end(), binary.begin(), binary.end());
  return file;
}

}  // namespace simvis::test
