#include "engine/geometry/mesh_cache.h"

#include <cctype>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <string>

#include "engine/base/cache_file.h"

namespace simvis {
namespace {

using ContentKey = std::array<std::uint64_t, 2>;

// Two chains of multiplications with different factors. The shift moves the high bits, where products accumulate, down
// again.
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

std::string file_name(std::string_view kind, const ContentKey& key) {
  char name[40];
  std::snprintf(name, sizeof name, "-%016llx%016llx.bin", static_cast<unsigned long long>(key[0]),
                static_cast<unsigned long long>(key[1]));
  return std::string(kind) + name;
}

std::string_view bytes_of(std::span<const std::uint32_t> words) {
  return {reinterpret_cast<const char*>(words.data()), words.size_bytes()};
}

}  // namespace

MeshCacheFile::MeshCacheFile(const std::filesystem::path& folder, std::string_view kind, char version, const Mesh& mesh)
    : magic_{'S', 'I', 'M', 'V', 'I', 'S', static_cast<char>(std::toupper(kind.front())), version},
      key_(key_of(mesh)),
      file_(folder / file_name(kind, key_)) {}

MeshCacheFile::Header MeshCacheFile::header_for(std::span<const std::uint32_t> words) const {
  return {.magic = magic_, .key = key_, .words = words.size(), .checksum = cache_checksum(bytes_of(words))};
}

std::vector<std::uint32_t> MeshCacheFile::read() const {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file_, error);
  if (error || size < sizeof(Header)) return {};
  std::ifstream in(file_, std::ios::binary);
  Header header;
  if (!in.read(reinterpret_cast<char*>(&header), sizeof header)) return {};
  if (header.words > size || size != sizeof(Header) + header.words * sizeof(std::uint32_t)) return {};
  std::vector<std::uint32_t> words(header.words);
  if (!in.read(reinterpret_cast<char*>(words.data()), static_cast<std::streamsize>(bytes_of(words).size()))) return {};
  if (header != header_for(words)) return {};
  return words;
}

void MeshCacheFile::write(std::span<const std::uint32_t> words) const {
  const Header header = header_for(words);
  std::string content(reinterpret_cast<const char*>(&header), sizeof header);
  content += bytes_of(words);
  write_cache_file(file_, content);
}

}  // namespace simvis
