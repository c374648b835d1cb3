// The host reads what clients write: values, whole elements and requests. It also sees which clients are connected, and
// which are ready for the next frame.
#include <linux/futex.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstring>
#include <ctime>
#include <utility>

#include "engine/base/assert.h"
#include "exchange/clients/host.h"
#include "exchange/clients/shared_object.h"
#include "exchange/clients/shared_words.h"

namespace simvis {
namespace {

bool has_name(const simvis_client_area& area, std::string_view name) {
  char copy[SIMVIS_SHM_MAX_NAME + 1] = {};
  std::memcpy(copy, area.name, SIMVIS_SHM_MAX_NAME);
  return name == copy;
}

}  // namespace

simvis_client_area& SharedHost::area(std::size_t client) const {
  return reinterpret_cast<simvis_client_area*>(object_->at(object_->layout().clients_offset))[client];
}

bool SharedHost::holds_area(std::size_t client) const {
  return object_->is_locked(object_->layout().clients_offset + client * sizeof(simvis_client_area));
}

void SharedHost::refuse(std::uint32_t client, std::string_view why) {
  clients_[client].refused = true;
  log(SIMVIS_CLIENT_REFUSED,
      "what client " + std::to_string(client) + " wrote makes no sense and is ignored until " +
          "it connects again: " + std::string(why),
      client);
}

// Whether there is something to read: from a client, or from one that has left since the last take(). A new client
// begins with an empty ring and no groups.
bool SharedHost::refresh(std::uint32_t client) {
  Client& known = clients_[client];
  const std::uint64_t connection = load(area(client).connection);
  const std::uint64_t last_client = connection / 2 * 2;  // an odd number: this one has left
  if (last_client == 0 || connection == known.left) return false;
  if (connection % 2 == 1 && holds_area(client)) return false;  // the next client is clearing the area
  if (last_client != known.connection) {
    known.connection = last_client;
    known.refused = false;
    known.group_sequences.fill(0);
    known.request_tail = 0;
    store(area(client).request_tail, std::uint64_t{0});
    store(area(client).acknowledged, last_client);
  }
  if (connection % 2 == 1) known.left = connection;
  return !known.refused;
}

ClientInputs SharedHost::take() {
  ClientInputs inputs;
  take_values(inputs);
  for (std::uint32_t client = 0; client < SIMVIS_SHM_CLIENTS; ++client) {
    if (!refresh(client)) continue;
    take_groups(client, inputs);
    take_requests(client, inputs);
    const Client& known = clients_[client];
    if (known.left == known.connection + 1) store(area(client).acknowledged, known.left);  // the area is free
  }
  return inputs;
}

void SharedHost::take_values(ClientInputs& inputs) {
  const auto* const words = reinterpret_cast<std::uint64_t*>(object_->at(object_->layout().values.offset));
  for (std::size_t i = 0; i < values_.size(); ++i) {
    const std::uint64_t bits = load_relaxed(words[i]);
    if (bits == std::bit_cast<std::uint64_t>(values_[i])) continue;
    values_[i] = std::bit_cast<double>(bits);
    inputs.values.push_back({i, values_[i]});
  }
}

void SharedHost::set_value(std::size_t parameter, double value) {
  SIMVIS_ASSERT(parameter < values_.size());
  auto* const words = reinterpret_cast<std::uint64_t*>(object_->at(object_->layout().values.offset));
  std::uint64_t known = std::bit_cast<std::uint64_t>(values_[parameter]);
  __atomic_compare_exchange_n(&words[parameter], &known, std::bit_cast<std::uint64_t>(value), false, __ATOMIC_RELAXED,
                              __ATOMIC_RELAXED);
  values_[parameter] = value;  // a client's newer value differs from it, and is taken next time
}

void SharedHost::take_groups(std::uint32_t client, ClientInputs& inputs) {
  const simvis_client_area& written = area(client);
  const std::uint64_t count = std::min<std::uint64_t>(load(written.group_count), SIMVIS_SHM_GROUPS);
  for (std::size_t g = 0; g < count; ++g) {
    const simvis_group& group = written.groups[g];
    const std::uint64_t sequence = load(group.sequence);
    if (sequence == clients_[client].group_sequences[g] || sequence % 2 == 1) continue;  // 0: never written
    const std::uint64_t element = load_relaxed(group.element);
    std::array<double, SIMVIS_SHM_GROUP_VALUES> values;
    for (std::size_t i = 0; i < values.size(); ++i) {
      __atomic_load(&group.values[i], &values[i], __ATOMIC_RELAXED);
    }
    std::atomic_thread_fence(std::memory_order_acquire);
    if (load_relaxed(group.sequence) != sequence) continue;  // it is being written again: next time
    clients_[client].group_sequences[g] = sequence;
    const bool known = element < element_removed_.size();
    const std::size_t parameters = known ? first_parameter_[element + 1] - first_parameter_[element] : 0;
    if (!known || parameters > values.size()) {
      return refuse(client, known ? "an element with too many parameters is written as a whole"
                                  : "an element that does not exist is written as a whole");
    }
    if (element_removed_[element]) continue;  // it was removed while the client wrote
    inputs.elements.push_back(
        {client, static_cast<std::size_t>(element), {values.begin(), values.begin() + static_cast<long>(parameters)}});
  }
}

void SharedHost::take_requests(std::uint32_t client, ClientInputs& inputs) {
  simvis_client_area& written = area(client);
  Client& known = clients_[client];
  const std::uint64_t head = load(written.request_head);
  std::uint64_t left = head - known.request_tail;
  if (left > SIMVIS_SHM_REQUEST_BYTES) return refuse(client, "more requests than the ring holds");
  if (object_->layout().log.count > kLogBytesOfClients) return;
  const auto copy_out = [&](void* to, std::uint64_t from, std::uint64_t size) {
    const std::uint64_t start = from % SIMVIS_SHM_REQUEST_BYTES;
    const std::uint64_t first = std::min(size, SIMVIS_SHM_REQUEST_BYTES - start);
    std::memcpy(to, written.requests + start, first);
    std::memcpy(static_cast<unsigned char*>(to) + first, written.requests, size - first);
  };
  while (left > 0) {
    simvis_request request{};
    if (left < sizeof request) return refuse(client, "a piece of a request");
    copy_out(&request, known.request_tail, sizeof request);
    left -= sizeof request;
    if (request.size > left || round_up(request.size, 8) > left) return refuse(client, "a request without its end");
    ChangeRequest taken{client, request.number, std::string(request.size, '\0')};
    copy_out(taken.text.data(), known.request_tail + sizeof request, request.size);
    left -= round_up(request.size, 8);
    known.request_tail = head - left;
    inputs.requests.push_back(std::move(taken));
  }
  store(written.request_tail, known.request_tail);
}

bool SharedHost::is_connected(std::string_view client) const {
  for (std::size_t i = 0; i < SIMVIS_SHM_CLIENTS; ++i) {
    const std::uint64_t connection = load(area(i).connection);
    if (connection != 0 && connection % 2 == 0 && has_name(area(i), client) && holds_area(i)) return true;
  }
  return false;
}

bool SharedHost::is_ready(std::string_view client, std::uint64_t index) const {
  for (std::size_t i = 0; i < SIMVIS_SHM_CLIENTS; ++i) {
    const std::uint64_t connection = load(area(i).connection);
    if (connection == 0 || connection % 2 == 1 || !has_name(area(i), client)) continue;
    if (load(area(i).ready_frames) > index) return true;
  }
  return false;
}

std::uint32_t SharedHost::ready_counter() const { return load(object_->shared().ready_futex); }

void SharedHost::wait_for_ready(std::uint32_t seen, std::int64_t timeout_ns) const {
  const timespec rest{timeout_ns / 1'000'000'000, timeout_ns % 1'000'000'000};
  ::syscall(SYS_futex, &object_->shared().ready_futex, FUTEX_WAIT, seen, &rest, nullptr, 0);
}

}  // namespace simvis
