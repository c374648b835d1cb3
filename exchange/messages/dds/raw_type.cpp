#include "exchange/messages/dds/raw_type.h"

#include <dds/ddsi/q_radmin.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <memory>
#include <new>

#include "engine/base/assert.h"

namespace simvis::ros {

namespace {

// Cyclone sends whole words of 4 bytes.
constexpr std::size_t kWord = 4;

struct RawType : ddsi_sertype {
  std::size_t max_bytes = 0;
};

struct RawSample : ddsi_serdata {
  RawSample(const ddsi_sertype* of, ddsi_serdata_kind kind, std::size_t used) : ddsi_serdata{} {
    ddsi_serdata_init(this, of, kind);
    bytes.resize((used + kWord - 1) / kWord * kWord);
  }
  std::string bytes;
};

const RawSample& raw(const ddsi_serdata* sample) { return *static_cast<const RawSample*>(sample); }

// All memory that the network asks for is allocated here: what does not fit is not received.
std::unique_ptr<RawSample> received_sample(const ddsi_sertype* type, ddsi_serdata_kind kind, std::size_t size) {
  if (size > static_cast<const RawType*>(type)->max_bytes) return nullptr;
  try {
    return std::make_unique<RawSample>(type, kind, size);
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}

ddsi_serdata* from_fragments(const ddsi_sertype* type, ddsi_serdata_kind kind, const nn_rdata* fragment,
                             std::size_t size) {
  std::unique_ptr<RawSample> sample = received_sample(type, kind, size);
  if (!sample) return nullptr;
  std::size_t end = 0;
  for (; fragment != nullptr; fragment = fragment->nextfrag) {
    if (fragment->maxp1 <= end) continue;  // fragments may overlap
    if (fragment->min > end || fragment->maxp1 > size) return nullptr;
    const unsigned char* const payload = NN_RMSG_PAYLOADOFF(fragment->rmsg, NN_RDATA_PAYLOAD_OFF(fragment));
    std::memcpy(sample->bytes.data() + end, payload + (end - fragment->min), fragment->maxp1 - end);
    end = fragment->maxp1;
  }
  return end == size ? sample.release() : nullptr;
}

ddsi_serdata* from_pieces(const ddsi_sertype* type, ddsi_serdata_kind kind, ddsrt_msg_iovlen_t count,
                          const ddsrt_iovec_t* pieces, std::size_t size) {
  std::unique_ptr<RawSample> sample = received_sample(type, kind, size);
  if (!sample) return nullptr;
  std::size_t end = 0;
  for (ddsrt_msg_iovlen_t i = 0; i < count; ++i) {
    const std::size_t bytes = std::min<std::size_t>(pieces[i].iov_len, size - end);
    if (bytes > 0) std::memcpy(sample->bytes.data() + end, pieces[i].iov_base, bytes);
    end += bytes;
  }
  return end == size ? sample.release() : nullptr;
}

ddsi_serdata* from_keyhash(const ddsi_sertype* type, const ddsi_keyhash*) { return new RawSample(type, SDK_KEY, 0); }

// Samples are made by make_raw_sample() alone.
ddsi_serdata* from_application(const ddsi_sertype*, ddsi_serdata_kind, const void*) { return nullptr; }

void copy_out(const ddsi_serdata* sample, std::size_t offset, std::size_t size, void* to) {
  std::memcpy(to, raw(sample).bytes.data() + offset, size);
}

ddsi_serdata* lend(const ddsi_serdata* sample, std::size_t offset, std::size_t size, ddsrt_iovec_t* piece) {
  piece->iov_base = const_cast<char*>(raw(sample).bytes.data() + offset);
  piece->iov_len = static_cast<ddsrt_iov_len_t>(size);
  return ddsi_serdata_ref(sample);
}

ddsi_serdata* without_data(const ddsi_serdata* sample) {
  auto* const made = new RawSample(sample->type, SDK_KEY, 0);
  made->type = nullptr;
  return made;
}

std::size_t print(const ddsi_sertype*, const ddsi_serdata*, char* text, std::size_t) {
  *text = '\0';
  return 0;
}

const ddsi_serdata_ops kSampleOperations = {
    .eqkey = [](const ddsi_serdata*, const ddsi_serdata*) { return true; },
    .get_size = [](const ddsi_serdata* sample) { return static_cast<std::uint32_t>(raw(sample).bytes.size()); },
    .from_ser = from_fragments,
    .from_ser_iov = from_pieces,
    .from_keyhash = from_keyhash,
    .from_sample = from_application,
    .to_ser = copy_out,
    .to_ser_ref = lend,
    .to_ser_unref = [](ddsi_serdata* sample, const ddsrt_iovec_t*) { ddsi_serdata_unref(sample); },
    .to_sample = [](const ddsi_serdata*, void*, void**, void*) { return false; },
    .to_untyped = without_data,
    .untyped_to_sample = [](const ddsi_sertype*, const ddsi_serdata*, void*, void**, void*) { return true; },
    .free = [](ddsi_serdata* sample) { delete static_cast<RawSample*>(sample); },
    .print = print,
    .get_keyhash = [](const ddsi_serdata*, ddsi_keyhash* hash, bool) { *hash = {}; },
#ifdef DDS_HAS_SHM
    .get_sample_size = ddsi_serdata_iox_size,
    .from_iox_buffer = [](const ddsi_sertype*, ddsi_serdata_kind, void*, void*) -> ddsi_serdata* { return nullptr; },
#endif
};

void free_type(ddsi_sertype* type) {
  ddsi_sertype_fini(type);
  delete static_cast<RawType*>(type);
}

const ddsi_sertype_ops kTypeOperations = {
    .version = ddsi_sertype_v0,
    .arg = nullptr,
    .free = free_type,
    .zero_samples = [](const ddsi_sertype*, void*, std::size_t) {},
    .realloc_samples = [](void**, const ddsi_sertype*, void*, std::size_t, std::size_t) { SIMVIS_ASSERT(false); },
    .free_samples = [](const ddsi_sertype*, void**, std::size_t, dds_free_op_t) {},
    .equal =
        [](const ddsi_sertype* a, const ddsi_sertype* b) {
          return static_cast<const RawType*>(a)->max_bytes == static_cast<const RawType*>(b)->max_bytes;
        },
    .hash =
        [](const ddsi_sertype* type) {
          return static_cast<std::uint32_t>(static_cast<const RawType*>(type)->max_bytes);
        },
    .type_id = nullptr,
    .type_map = nullptr,
    .type_info = nullptr,
    .derive_sertype = nullptr,
    .get_serialized_size = [](const ddsi_sertype*, const void*) { return std::size_t{0}; },
    .serialize_into = [](const ddsi_sertype*, const void*, void*, std::size_t) { return false; },
};

}  // namespace

ddsi_sertype* make_raw_type(const std::string& name, std::size_t max_bytes) {
  auto* const type = new RawType{};
  ddsi_sertype_init_flags(type, name.c_str(), &kTypeOperations, &kSampleOperations, DDSI_SERTYPE_FLAG_TOPICKIND_NO_KEY);
  type->allowed_data_representation = DDS_DATA_REPRESENTATION_FLAG_XCDR1;
  type->max_bytes = max_bytes;
  return type;
}

ddsi_serdata* make_raw_sample(const ddsi_sertype& type, std::string_view bytes) {
  auto* const sample = new RawSample(&type, SDK_DATA, bytes.size());
  bytes.copy(sample->bytes.data(), bytes.size());
  return sample;
}

std::string_view bytes_of(const ddsi_serdata& sample) { return raw(&sample).bytes; }

}  // namespace simvis::ros
