#include "import/gltf/gltf_accessors.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <type_traits>

namespace simvis {
namespace {

// An accessor without a buffer view holds zeros that use no bytes of the file, so the file size does not limit it.
constexpr std::size_t kMaxElementsWithoutBytes = 1u << 20;

// The number of elements whose file bytes are in memory at the same time.
constexpr std::size_t kBlock = 1u << 16;

unsigned format_of(int component_type, bool normalized) {
  switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return normalized ? kGltfI8n : kGltfI8;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return normalized ? kGltfU8n : kGltfU8;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return normalized ? kGltfI16n : kGltfI16;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return normalized ? kGltfU16n : kGltfU16;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return normalized ? 0 : kGltfU32;
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return normalized ? 0 : kGltfF32;
    default:
      return 0;
  }
}

std::string format_names(unsigned formats) {
  constexpr const char* kNames[] = {"BYTE",
                                    "UNSIGNED_BYTE",
                                    "SHORT",
                                    "UNSIGNED_SHORT",
                                    "UNSIGNED_INT",
                                    "FLOAT",
                                    "normalized BYTE",
                                    "normalized UNSIGNED_BYTE",
                                    "normalized SHORT",
                                    "normalized UNSIGNED_SHORT"};
  std::string text;
  for (unsigned bit = 0; bit < std::size(kNames); ++bit) {
    if ((formats >> bit & 1u) != 0) text += (text.empty() ? "" : ", ") + std::string(kNames[bit]);
  }
  return text.empty() ? "a format that glTF does not have" : text;
}

std::string type_names(std::span<const int> types) {
  std::string text;
  for (const int type : types) {
    const char* name = type == TINYGLTF_TYPE_SCALAR ? "SCALAR"
                       : type == TINYGLTF_TYPE_VEC2 ? "VEC2"
                       : type == TINYGLTF_TYPE_VEC3 ? "VEC3"
                       : type == TINYGLTF_TYPE_VEC4 ? "VEC4"
                       : type == TINYGLTF_TYPE_MAT4 ? "MAT4"
                                                    : "a matrix";
    text += (text.empty() ? "" : " or ") + std::string(name);
  }
  return text;
}

float component(const std::uint8_t* p, unsigned format) {
  const auto load = [p](auto value) {
    std::memcpy(&value, p, sizeof value);
    return value;
  };
  // The division is in double and the result is rounded once. The most negative integer means -1, like its neighbour.
  const auto normalized = [](double value, double most) { return static_cast<float>(std::max(value / most, -1.0)); };
  switch (format) {
    case kGltfI8:
      return load(std::int8_t{});
    case kGltfU8:
      return load(std::uint8_t{});
    case kGltfI16:
      return load(std::int16_t{});
    case kGltfU16:
      return load(std::uint16_t{});
    case kGltfI8n:
      return normalized(load(std::int8_t{}), 127);
    case kGltfU8n:
      return normalized(load(std::uint8_t{}), 255);
    case kGltfI16n:
      return normalized(load(std::int16_t{}), 32767);
    case kGltfU16n:
      return normalized(load(std::uint16_t{}), 65535);
    default:
      return load(float{});
  }
}

std::uint32_t integer_component(const std::uint8_t* p, unsigned format) {
  if (format == kGltfU8) return *p;
  if (format == kGltfU16) {
    std::uint16_t value;
    std::memcpy(&value, p, sizeof value);
    return value;
  }
  std::uint32_t value;
  std::memcpy(&value, p, sizeof value);
  return value;
}

bool view_has_data(const GltfDocument& document, int buffer_view) {
  const tinygltf::BufferView& view = document.model.bufferViews[static_cast<std::size_t>(buffer_view)];
  return !document.buffers[static_cast<std::size_t>(view.buffer)].empty();
}

struct ViewPlace {
  const GltfBuffer& buffer;
  std::size_t first, size;
};

ViewPlace locate_view(const GltfDocument& document, int buffer_view, const std::string& place) {
  const tinygltf::BufferView& view = document.model.bufferViews[static_cast<std::size_t>(buffer_view)];
  const GltfBuffer& buffer = document.buffers[static_cast<std::size_t>(view.buffer)];
  if (view.byteOffset > buffer.size() || view.byteLength > buffer.size() - view.byteOffset) {
    document.fail(place + " reads bufferViews/" + std::to_string(buffer_view) + ", which ends at byte " +
                  std::to_string(view.byteOffset + view.byteLength) + " of buffers/" + std::to_string(view.buffer) +
                  ", which has " + std::to_string(buffer.size()));
  }
  return {buffer, view.byteOffset, view.byteLength};
}

class AccessorReader {
 public:
  AccessorReader(const GltfDocument& document, int accessor, const char* use)
      : document_(document),
        accessor_(document.model.accessors[static_cast<std::size_t>(accessor)]),
        place_("accessors/" + std::to_string(accessor) + (*use == 0 ? "" : " (" + std::string(use) + ")")),
        format_(format_of(accessor_.componentType, accessor_.normalized)),
        component_bytes_(component_size(accessor_.componentType)),
        components_(
            static_cast<std::size_t>(tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor_.type)))) {}

  void expect(const GltfUse& use) const {
    if (std::find(use.types.begin(), use.types.end(), accessor_.type) == use.types.end()) {
      fail("is of type " + type_names(std::span(&accessor_.type, 1)) + "; expected " + type_names(use.types));
    }
    const bool quantized = document_.uses("KHR_mesh_quantization");
    const unsigned allowed = use.formats | (quantized ? use.quantized_formats : 0);
    if ((format_ & allowed) == 0) {
      fail("holds " + format_names(format_) + "; expected " + format_names(allowed) +
           ((format_ & use.quantized_formats) != 0 ? ", or KHR_mesh_quantization in extensionsUsed" : ""));
    }
  }

  // Checks that all bytes lie within the buffer view. A buffer that the file leaves out is an error only if it is read.
  void check_layout() const {
    if (format_ == 0) fail("holds a combination of componentType and normalized that glTF does not have");
    if (accessor_.bufferView >= 0 && view_has_data(document_, accessor_.bufferView)) dense_elements();
    if (accessor_.sparse.isSparse && view_has_data(document_, accessor_.sparse.indices.bufferView) &&
        view_has_data(document_, accessor_.sparse.values.bufferView)) {
      sparse_elements();
    }
  }

  std::size_t count() const { return accessor_.count; }
  std::size_t components() const { return components_; }

  template <class T>
  std::vector<T> read() const {
    std::vector<T> values;
    if (accessor_.bufferView < 0) {
      if (count() > kMaxElementsWithoutBytes) {
        fail("has no bufferView, and " + std::to_string(count()) + " elements; expected at most " +
             std::to_string(kMaxElementsWithoutBytes));
      }
      values.resize(count() * components_);
    } else {
      const Elements elements = dense_elements();
      values.resize(count() * components_);
      for (std::size_t first = 0; first < count(); first += kBlock) {
        const std::size_t end = std::min(count(), first + kBlock);
        const Bytes bytes = elements.read(first, end);
        for (std::size_t i = first; i < end; ++i) {
          copy_element(bytes.data() + (i - first) * elements.stride, values.data() + i * components_);
        }
      }
    }
    if (accessor_.sparse.isSparse) replace_sparse(values);
    if constexpr (std::is_same_v<T, float>) check_finite(values);
    return values;
  }

 private:
  static std::size_t component_size(int component_type) {
    return static_cast<std::size_t>(tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(component_type)));
  }

  // The layout of elements in a buffer.
  struct Elements {
    const GltfBuffer& buffer;
    std::size_t place, stride, element_bytes;

    // Reads the elements from `first` up to `end`, including the gaps between them.
    Bytes read(std::size_t first, std::size_t end) const {
      if (first == end) return {};
      return buffer.read(place + first * stride, (end - 1 - first) * stride + element_bytes);
    }
  };

  Elements dense_elements() const {
    const tinygltf::BufferView& view = document_.model.bufferViews[static_cast<std::size_t>(accessor_.bufferView)];
    const std::size_t element_bytes = component_bytes_ * components_;
    const std::size_t stride = view.byteStride == 0 ? element_bytes : view.byteStride;
    if (stride < element_bytes) {
      fail("has elements of " + std::to_string(element_bytes) + " bytes, but the buffer view's byteStride is " +
           std::to_string(stride));
    }
    return locate(accessor_.bufferView, accessor_.byteOffset, count(), stride, element_bytes);
  }

  struct SparseElements {
    Elements indices, values;
    std::size_t count;
    unsigned index_format;
  };

  SparseElements sparse_elements() const {
    const auto& sparse = accessor_.sparse;
    const auto replaced = static_cast<std::size_t>(sparse.count);
    if (replaced > count()) fail("replaces " + std::to_string(replaced) + " elements of " + std::to_string(count()));
    constexpr unsigned kIndexFormats = kGltfU8 | kGltfU16 | kGltfU32;
    const unsigned format = format_of(sparse.indices.componentType, false);
    if ((format & kIndexFormats) == 0) {
      fail("has sparse indices of " + format_names(format) + "; expected " + format_names(kIndexFormats));
    }
    const std::size_t index_bytes = component_size(sparse.indices.componentType);
    const std::size_t element_bytes = component_bytes_ * components_;
    return {locate(sparse.indices.bufferView, static_cast<std::size_t>(sparse.indices.byteOffset), replaced,
                   index_bytes, index_bytes),
            locate(sparse.values.bufferView, static_cast<std::size_t>(sparse.values.byteOffset), replaced,
                   element_bytes, element_bytes),
            replaced, format};
  }

  template <class T>
  void copy_element(const std::uint8_t* source, T* target) const {
    for (std::size_t c = 0; c < components_; ++c, source += component_bytes_) {
      if constexpr (std::is_same_v<T, float>) {
        target[c] = component(source, format_);
      } else {
        target[c] = integer_component(source, format_);
      }
    }
  }

  // Locates `count` elements within a buffer view. Sizes stay far below 2^64; see the ranges in gltf_schema.cpp.
  Elements locate(int buffer_view, std::size_t offset, std::size_t count, std::size_t stride,
                  std::size_t element_bytes) const {
    const ViewPlace view = locate_view(document_, buffer_view, place_);
    const std::size_t needed = offset + (count - 1) * stride + element_bytes;
    if (needed > view.size) {
      fail("reaches to byte " + std::to_string(needed) + " of bufferViews/" + std::to_string(buffer_view) +
           ", which has " + std::to_string(view.size));
    }
    return {view.buffer, view.first + offset, stride, element_bytes};
  }

  template <class T>
  void replace_sparse(std::vector<T>& values) const {
    const SparseElements sparse = sparse_elements();
    const Bytes indices = sparse.indices.read(0, sparse.count), replacing = sparse.values.read(0, sparse.count);
    std::int64_t last = -1;
    for (std::size_t i = 0; i < sparse.count; ++i) {
      const std::uint32_t index = integer_component(indices.data() + i * sparse.indices.stride, sparse.index_format);
      if (index >= count() || index <= last) {
        fail("has the sparse index " + std::to_string(index) + " after " + std::to_string(last) +
             "; expected increasing indices below " + std::to_string(count()));
      }
      last = index;
      copy_element(replacing.data() + i * sparse.values.stride, values.data() + index * components_);
    }
  }

  void check_finite(const std::vector<float>& values) const {
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!std::isfinite(values[i]))
        fail("has a value that is not finite in element " + std::to_string(i / components_));
    }
  }

  [[noreturn]] void fail(const std::string& what) const { document_.fail(place_ + " " + what); }

  const GltfDocument& document_;
  const tinygltf::Accessor& accessor_;
  std::string place_;
  unsigned format_;
  std::size_t component_bytes_, components_;
};

}  // namespace

GltfFloats read_floats(const GltfDocument& document, int accessor, const GltfUse& use) {
  const AccessorReader reader(document, accessor, use.name);
  reader.expect(use);
  return {reader.count(), reader.components(), reader.read<float>()};
}

GltfFloats read_vertex_floats(const GltfDocument& document, int accessor, const GltfUse& use, std::size_t vertices) {
  GltfFloats floats = read_floats(document, accessor, use);
  if (floats.count == vertices) return floats;
  document.fail("accessors/" + std::to_string(accessor) + " (" + use.name + ") has " + std::to_string(floats.count) +
                " elements; expected " + std::to_string(vertices) + ", as many as POSITION");
}

std::vector<std::uint32_t> read_integers(const GltfDocument& document, int accessor, const GltfUse& use) {
  const AccessorReader reader(document, accessor, use.name);
  reader.expect(use);
  return reader.read<std::uint32_t>();
}

void check_use(const GltfDocument& document, int accessor, const GltfUse& use) {
  AccessorReader(document, accessor, use.name).expect(use);
}

bool has_data(const GltfDocument& document, int accessor) {
  const tinygltf::Accessor& source = document.model.accessors[static_cast<std::size_t>(accessor)];
  const auto is_there = [&](int view) { return view >= 0 && view_has_data(document, view); };
  if (source.sparse.isSparse &&
      !(is_there(source.sparse.indices.bufferView) && is_there(source.sparse.values.bufferView))) {
    return false;
  }
  return source.bufferView < 0 ? source.sparse.isSparse : is_there(source.bufferView);
}

void check_accessors(const GltfDocument& document) {
  for (std::size_t i = 0; i < document.model.accessors.size(); ++i) {
    AccessorReader(document, static_cast<int>(i), "").check_layout();
  }
}

Bytes view_bytes(const GltfDocument& document, int buffer_view, const std::string& place) {
  const ViewPlace view = locate_view(document, buffer_view, place);
  return view.buffer.read(view.first, view.size);
}

}  // namespace simvis
