#include "engine/cluster_cache.h"

#include <array>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/cache_file.h"

namespace simvis {
namespace {

// 128 bits, so that no two meshes share a name by chance.
using ContentKey = std::array<std::uint64_t, 2>;

// The last character counts versions: of this format, and of what sort_in_space() makes of a mesh.
constexpr std::array<char, 8> kMagic{'S', 'I', 'M', 'V', 'I', 'S', 'C', '1'};

struct FileHeader {
  std::array<char, 8> magic = kMagic;
  ContentKey key{};
  std::uint64_t triangles = 0, checksum = 0;

  bool operator==(const FileHeader&) const = default;
};
static_assert(sizeof(FileHeader) == 40, "no padding");

// Two chains of multiplications that differ in their factor; the shift brings the high bits, where products gather,
// down again.
template <class T>
void add_to(ContentKey& key, const std::vector<T>& values) {
  const auto mix = [&key](std::uint64_t word) {
    key[0] = (key[0] ^ word) * 0x9e3779b97f4a7c15u;
    key[1] = (key[1] ^ word) * 0xd6e8feb86659fd93u;
    key[0] ^= key[0] >> 32;
    key[1] ^= key[1] >> 29;
  };
  const auto* bytes = reinterpret_cast<const char*>(values.data());
  std::size_t left = values.size() * sizeof(T);
  mix(left);
  for (; left > 0;) {
    std::uint64_t word = 0;
    const std::size_t size = std::min(left, sizeof word);
    std::memcpy(&word, bytes, size);
    mix(word);
    bytes += size;
    left -= size;
  }
}

ContentKey key_of(const Mesh& mesh) {
  ContentKey key{1, 2};
  add_to(key, mesh.positions);
  add_to(key, mesh.indices);
  return key;
}

std::string file_name(const ContentKey& key) {
  char name[64];
  std::snprintf(name, sizeof name, "clusters-%016llx%016llx.bin", static_cast<unsigned long long>(key[0]),
                static_cast<unsigned long long>(key[1]));
  return name;
}

std::string_view bytes_of(const std::vector<std::uint32_t>& order) {
  return {reinterpret_cast<const char*>(order.data()), order.size() * sizeof order[0]};
}

FileHeader header_for(const ContentKey& key, const std::vector<std::uint32_t>& order) {
  return {.key = key, .triangles = order.size(), .checksum = cache_checksum(bytes_of(order))};
}

bool holds_each_once(const std::vector<std::uint32_t>& order) {
  std::vector<bool> seen(order.size());
  for (const std::uint32_t triangle : order) {
    if (triangle >= order.size() || seen[triangle]) return false;
    seen[triangle] = true;
  }
  return true;
}

// Empty unless all of the file is as it was written for this mesh.
std::vector<std::uint32_t> read(const std::filesystem::path& file, const ContentKey& key, std::size_t triangles) {
  std::error_code error;
  if (std::filesystem::file_size(file, error) != sizeof(FileHeader) + triangles * sizeof(std::uint32_t)) return {};
  std::ifstream in(file, std::ios::binary);
  FileHeader header;
  std::vector<std::uint32_t> order(triangles);
  if (!in.read(reinterpret_cast<char*>(&header), sizeof header)) return {};
  if (!in.read(reinterpret_cast<char*>(order.data()), static_cast<std::streamsize>(bytes_of(order).size()))) return {};
  if (header != header_for(key, order) || !holds_each_once(order)) return {};
  return order;
}

void write(const std::filesystem::path& file, const ContentKey& key, const std::vector<std::uint32_t>& order) {
  const FileHeader header = header_for(key, order);
  std::string content(reinterpret_cast<const char*>(&header), sizeof header);
  content += bytes_of(order);
  write_cache_file(file, content);
}

}  // namespace

Clustering make_clusters_cached(const Mesh& mesh, const std::filesystem::path& folder) {
  const std::size_t triangles = mesh.indices.size() / 3;
  if (folder.empty() || mesh.topology != Topology::triangles || triangles < kLeastCachedTriangles) {
    return make_clusters(mesh);
  }
  const ContentKey key = key_of(mesh);
  const std::filesystem::path file = folder / file_name(key);
  std::vector<std::uint32_t> order = read(file, key, triangles);
  if (order.empty()) {
    order = order_in_space(mesh);
    write(file, key, order);
  }
  return clusters_in_order(mesh, order);
}

}  // namespace simvis
