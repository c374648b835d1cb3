#include "clients/host.h"

#include <fcntl.h>
#include <linux/futex.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <cstring>
#include <ctime>
#include <random>
#include <utility>

#include <simvis/error.h>
#include "engine/base/assert.h"

namespace simvis {
namespace {

// Capacities of the tables. A table reserves address space for its capacity; only its used part takes memory.
constexpr std::uint64_t kElements = 1 << 20, kParameters = 1 << 21, kSensors = 1 << 12, kStringBytes = 64 << 20,
                        kLogBytes = 256 << 20, kOutputBytes = std::uint64_t{4} << 30;
// Memory is asked for in such pieces, so that a full file system is an error here and not a signal later.
constexpr std::uint64_t kPiece = 1 << 18, kPage = 4096, kCacheLine = 64;
// How many measurements of a sensor are there at a time: a reader has the time of this many less one to read one.
constexpr std::uint32_t kSlots = 4;
constexpr char kFolder[] = "/dev/shm";
// Clients cannot fill the log: beyond this share their refusals are no longer logged, and their requests wait for ever.
constexpr std::uint64_t kLogBytesOfClients = kLogBytes / 4 * 3;

std::uint64_t round_up(std::uint64_t value, std::uint64_t to) { return (value + to - 1) / to * to; }

template <typename T>
T load(const T& word) {
  return __atomic_load_n(&word, __ATOMIC_ACQUIRE);
}
template <typename T>
void store(T& word, T value) {
  __atomic_store_n(&word, value, __ATOMIC_RELEASE);
}
template <typename T>
T load_relaxed(const T& word) {
  return __atomic_load_n(&word, __ATOMIC_RELAXED);
}
template <typename T>
void store_relaxed(T& word, T value) {
  __atomic_store_n(&word, value, __ATOMIC_RELAXED);
}

std::uint64_t bits_of(double value) {
  std::uint64_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}
double value_of(std::uint64_t bits) {
  double value = 0;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

struct flock lock_of(std::uint64_t byte) {
  struct flock lock {};
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  lock.l_start = static_cast<off_t>(byte);
  lock.l_len = 1;
  return lock;
}

bool take_lock(int file, std::uint64_t byte) {
  struct flock lock = lock_of(byte);
  return ::fcntl(file, F_OFD_SETLK, &lock) == 0;
}

void wake(const std::uint32_t& word) { ::syscall(SYS_futex, &word, FUTEX_WAKE, INT_MAX, nullptr, nullptr, 0); }

[[noreturn]] void fail(const std::string& what) { throw MachineError(what + ": " + std::strerror(errno)); }

void check_name(const std::string& name) {
  const bool fits =
      !name.empty() && name.size() < SIMVIS_SHM_MAX_NAME &&
      name.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-") == std::string::npos;
  if (!fits) {
    throw InputError("\"" + name + "\" can't name a served simulation, expected 1 to " +
                     std::to_string(SIMVIS_SHM_MAX_NAME - 1) + " of A-Z a-z 0-9 . _ -");
  }
}

}  // namespace

// The file in memory and its mapping.
class SharedHost::Object {
 public:
  explicit Object(const std::string& name) : path_(std::string(kFolder) + SIMVIS_SHM_PREFIX + name) {
    make_unnamed();
    try {
      map();
      describe();
      // The lock is held before anybody can find the object.
      if (!take_lock(file_, SIMVIS_SHM_LOCK_BYTE)) fail("the shared memory can't be locked");
      give_name(name);
    } catch (...) {
      release();
      throw;
    }
  }

  ~Object() {
    store(shared().state, static_cast<std::uint32_t>(SIMVIS_ENDED));
    wake_frame();
    struct stat own {
    }, named{};
    if (::fstat(file_, &own) == 0 && ::stat(path_.c_str(), &named) == 0 && own.st_ino == named.st_ino) {
      ::unlink(path_.c_str());
    }
    release();
  }
  Object(const Object&) = delete;
  Object& operator=(const Object&) = delete;

  // The host's own copy of the offsets and counts, which no client can change.
  simvis_header& layout() { return layout_; }
  simvis_header& shared() { return *reinterpret_cast<simvis_header*>(memory_); }
  unsigned char* at(std::uint64_t offset) { return memory_ + offset; }
  int file() const { return file_; }

  void wake_frame() {
    store(shared().frame_futex, ++frame_futex_);
    wake(shared().frame_futex);
  }

  // Says that a region of layout() has this many entries.
  void publish_count(simvis_region& region, std::uint64_t count) {
    region.count = count;
    store((&shared().elements)[&region - &layout_.elements].count, count);
  }

  // Gives memory back to the system; it reads as 0 until it is allocated anew.
  void give_back(std::uint64_t offset, std::uint64_t bytes) {
    ::fallocate(file_, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, static_cast<off_t>(offset),
                static_cast<off_t>(bytes));
  }

  void allocate(std::uint64_t offset, std::uint64_t bytes) {
    const int error = ::posix_fallocate(file_, static_cast<off_t>(offset), static_cast<off_t>(bytes));
    if (error == 0) return;
    errno = error;
    fail("no memory is left in " + std::string(kFolder) + " for what is served");
  }

  // Asks the system for memory, so that writing to it can't fail.
  void ensure(const simvis_region& region, std::uint64_t bytes) {
    std::uint64_t& ensured = ensured_[&region - &layout_.elements];
    if (bytes <= ensured) return;
    const std::uint64_t wanted = std::min(round_up(bytes, kPiece), region.capacity * region.stride);
    allocate(region.offset + ensured, wanted - ensured);
    ensured = wanted;
  }

 private:
  void release() {
    if (memory_ != nullptr) ::munmap(memory_, layout_.total_size);
    ::close(file_);
  }

  void make_unnamed() {
    file_ = ::open(kFolder, O_TMPFILE | O_RDWR | O_CLOEXEC, S_IRUSR | S_IWUSR);
    if (file_ < 0) fail(std::string("no shared memory in ") + kFolder);
  }

  void map() {
    simvis_header& layout = layout_;
    std::uint64_t end = round_up(sizeof(simvis_header), kPage);
    layout.clients_offset = end;
    end = round_up(end + SIMVIS_SHM_CLIENTS * sizeof(simvis_client_area), kPage);
    const auto reserve = [&](simvis_region& region, std::uint64_t stride, std::uint64_t capacity) {
      region = {.offset = end, .stride = stride, .capacity = capacity, .count = 0};
      end = round_up(end + stride * capacity, kPage);
    };
    reserve(layout.elements, sizeof(simvis_element), kElements);
    reserve(layout.parameters, sizeof(simvis_parameter), kParameters);
    reserve(layout.values, sizeof(double), kParameters);
    reserve(layout.applied, sizeof(double), kParameters);
    reserve(layout.strings, 1, kStringBytes);
    reserve(layout.log, 1, kLogBytes);
    reserve(layout.sensors, sizeof(simvis_sensor), kSensors);
    reserve(layout.outputs, 1, kOutputBytes);
    layout.total_size = end;
    if (::ftruncate(file_, static_cast<off_t>(end)) != 0) fail("the shared memory can't be made");
    allocate(0, layout.elements.offset);
    void* const memory = ::mmap(nullptr, end, PROT_READ | PROT_WRITE, MAP_SHARED, file_, 0);
    if (memory == MAP_FAILED) fail("the shared memory can't be mapped");
    memory_ = static_cast<unsigned char*>(memory);
  }

  void describe() {
    simvis_header& made = layout_;
    made.magic = SIMVIS_SHM_MAGIC;
    made.version = SIMVIS_SHM_VERSION;
    made.header_size = sizeof made;
    std::random_device random;
    made.generation = std::uint64_t{random()} << 32 | random();
    made.host_pid = ::getpid();
    made.state = SIMVIS_RUNNING;
    shared() = made;
  }

  // Links the complete object under its name. What a dead host left there goes; whoever takes the lock on it may do
  // that.
  void give_name(const std::string& name) {
    const std::string own = "/proc/self/fd/" + std::to_string(file_);
    while (::linkat(AT_FDCWD, own.c_str(), AT_FDCWD, path_.c_str(), AT_SYMLINK_FOLLOW) != 0) {
      if (errno != EEXIST) fail("the shared memory " + path_ + " can't get its name");
      const int before = ::open(path_.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW);
      if (before < 0 && errno == ENOENT) continue;
      if (before < 0) fail("the shared memory " + path_ + " can't be opened");
      const bool is_dead = take_lock(before, SIMVIS_SHM_LOCK_BYTE);
      struct stat locked {
      }, named{};
      const bool is_it =
          ::fstat(before, &locked) == 0 && ::stat(path_.c_str(), &named) == 0 && locked.st_ino == named.st_ino;
      if (is_dead && is_it) ::unlink(path_.c_str());
      ::close(before);
      if (!is_dead) throw InputError("a living simulation is served as \"" + name + "\", expected another name");
    }
  }

  std::string path_;
  int file_ = -1;
  unsigned char* memory_ = nullptr;
  simvis_header layout_{};
  std::uint32_t frame_futex_ = 0;
  std::array<std::uint64_t, 8> ensured_{};  // bytes by region, in the order of the header
};

// The host's private record of a client, copied from the client's area at the last take().
struct SharedHost::Client {
  std::uint64_t connection = 0, request_tail = 0;
  std::uint64_t left = 0;  // the odd number that the client left behind, once the area has been read for the last time
  bool refused = false;    // its area makes no sense; ignored until another client connects
  std::array<std::uint64_t, SIMVIS_SHM_GROUPS> group_sequences{};
};

SharedHost::SharedHost(std::string name)
    : object_((check_name(name), std::make_unique<Object>(name))), clients_(SIMVIS_SHM_CLIENTS), first_parameter_{0} {}
SharedHost::~SharedHost() = default;

template <typename T>
T* SharedHost::append(simvis_region& region, std::size_t count) {
  SIMVIS_ASSERT(sizeof(T) == region.stride);
  if (count > region.capacity - region.count) throw MachineError("the tables of the shared memory are full");
  object_->ensure(region, (region.count + count) * region.stride);
  return reinterpret_cast<T*>(object_->at(region.offset)) + region.count;
}

simvis_text SharedHost::add_text(std::string_view text) {
  simvis_region& strings = object_->layout().strings;
  char* const place = append<char>(strings, text.size());
  text.copy(place, text.size());
  const simvis_text added{strings.count, text.size()};
  object_->publish_count(strings, strings.count + text.size());
  return added;
}

std::size_t SharedHost::add_element(std::string_view name, std::string_view type, std::string_view insertion_point,
                                    std::span<const SharedParameter> parameters) {
  simvis_header& header = object_->layout();
  const std::size_t id = element_removed_.size();
  for (const SharedParameter& parameter : parameters) {
    *append<simvis_parameter>(header.parameters, 1) = {
        .name = add_text(parameter.name),
        .unit = add_text(parameter.unit),
        .min = parameter.min,
        .max = parameter.max,
        .element = id,
        .flags = (parameter.open_min ? 1u * SIMVIS_OPEN_MIN : 0u) | (parameter.open_max ? 1u * SIMVIS_OPEN_MAX : 0u),
        .reserved = 0};
    *append<double>(header.values, 1) = parameter.value;
    *append<double>(header.applied, 1) = parameter.value;
    values_.push_back(parameter.value);
    for (simvis_region* const region : {&header.values, &header.applied, &header.parameters}) {
      object_->publish_count(*region, values_.size());
    }
  }
  *append<simvis_element>(header.elements, 1) = {.name = add_text(name),
                                                 .type = add_text(type),
                                                 .insertion_point = add_text(insertion_point),
                                                 .first_parameter = first_parameter_.back(),
                                                 .parameter_count = static_cast<std::uint32_t>(parameters.size()),
                                                 .removed = 0};
  first_parameter_.push_back(values_.size());
  element_removed_.push_back(false);
  object_->publish_count(header.elements, id + 1);
  return id;
}

void SharedHost::remove_element(std::size_t element) {
  simvis_header& header = object_->layout();
  element_removed_.at(element) = true;
  store(reinterpret_cast<simvis_element*>(object_->at(header.elements.offset))[element].removed, 1u);
}

std::size_t SharedHost::add_sensor(std::string_view name, std::string_view type) {
  simvis_region& table = object_->layout().sensors;
  *append<simvis_sensor>(table, 1) = {.name = add_text(name),
                                      .type = add_text(type),
                                      .slots_offset = 0,
                                      .slot_size = 0,
                                      .slot_count = kSlots,
                                      .removed = 0,
                                      .measurement = 0};
  sensors_.emplace_back();
  object_->publish_count(table, sensors_.size());
  return sensors_.size() - 1;
}

simvis_sensor& SharedHost::shared_sensor(std::size_t sensor) {
  return reinterpret_cast<simvis_sensor*>(object_->at(object_->layout().sensors.offset))[sensor];
}

void SharedHost::remove_sensor(std::size_t sensor) {
  store(shared_sensor(sensor).removed, 1u);
  free_slots(sensor);
}

// A client that still reads there finds another sequence and knows that its view is not whole any more.
void SharedHost::free_slots(std::size_t sensor) {
  Sensor& own = sensors_.at(sensor);
  if (own.slot_size == 0) return;
  simvis_sensor& shared = shared_sensor(sensor);
  store(shared.measurement, std::uint64_t{0});
  store(shared.slots_offset, std::uint64_t{0});
  store(shared.slot_size, std::uint64_t{0});
  object_->give_back(own.slots_offset, own.slot_size * kSlots);
  free_slots_.emplace(own.slots_offset, own.slot_size * kSlots);
  own.slots_offset = own.slot_size = own.measurement = 0;
}

// The first free piece that is large enough, else new memory.
std::uint64_t SharedHost::take_slots(std::uint64_t bytes) {
  const auto free = std::ranges::find_if(free_slots_, [&](const auto& each) { return each.second >= bytes; });
  if (free != free_slots_.end()) {
    const auto [offset, size] = *free;
    object_->allocate(offset, bytes);
    free_slots_.erase(free);
    if (size > bytes) free_slots_.emplace(offset + bytes, size - bytes);
    return offset;
  }
  simvis_region& outputs = object_->layout().outputs;
  append<char>(outputs, bytes);
  const std::uint64_t offset = outputs.offset + outputs.count;
  object_->publish_count(outputs, outputs.count + bytes);
  return offset;
}

void SharedHost::log(simvis_log_kind kind, std::string_view text, std::uint32_t client, std::uint64_t request) {
  simvis_region& region = object_->layout().log;
  if (kind != SIMVIS_CHANGE && region.count > kLogBytesOfClients) return;
  const std::size_t size = round_up(sizeof(simvis_log_entry) + text.size(), 8);
  char* const place = append<char>(region, size);
  const simvis_log_entry entry{.size = static_cast<std::uint32_t>(size),
                               .kind = static_cast<std::uint32_t>(kind),
                               .request = request,
                               .client = client,
                               .text_size = static_cast<std::uint32_t>(text.size()),
                               .frame = next_frame_};
  std::memcpy(place, &entry, sizeof entry);
  text.copy(place + sizeof entry, text.size());
  object_->publish_count(region, region.count + size);
}

simvis_client_area& SharedHost::area(std::size_t client) const {
  return reinterpret_cast<simvis_client_area*>(object_->at(object_->layout().clients_offset))[client];
}

// The kernel knows: the lock ends with the process.
bool SharedHost::holds_area(std::size_t client) const {
  struct flock lock = lock_of(object_->layout().clients_offset + client * sizeof(simvis_client_area));
  return ::fcntl(object_->file(), F_OFD_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
}

void SharedHost::refuse(std::uint32_t client, std::string_view why) {
  clients_[client].refused = true;
  log(SIMVIS_CLIENT_REFUSED,
      "what client " + std::to_string(client) + " wrote makes no sense and is ignored until " +
          "it connects anew: " + std::string(why),
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
    if (bits == bits_of(values_[i])) continue;
    values_[i] = value_of(bits);
    inputs.values.push_back({i, values_[i]});
  }
}

void SharedHost::set_value(std::size_t parameter, double value) {
  SIMVIS_ASSERT(parameter < values_.size());
  auto* const words = reinterpret_cast<std::uint64_t*>(object_->at(object_->layout().values.offset));
  std::uint64_t known = bits_of(values_[parameter]);
  __atomic_compare_exchange_n(&words[parameter], &known, bits_of(value), false, __ATOMIC_RELAXED, __ATOMIC_RELAXED);
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
                                  : "an element that there is not is written as a whole");
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

void SharedHost::publish(std::size_t sensor, std::uint64_t frame, std::int64_t time_ns,
                         std::span<const double> world_from_sensor, std::span<const SharedOutput> outputs) {
  SIMVIS_ASSERT(sensor < sensors_.size() && world_from_sensor.size() == 16 && outputs.size() <= SIMVIS_SHM_MAX_OUTPUTS);
  Sensor& own = sensors_[sensor];
  simvis_sensor& shared = shared_sensor(sensor);
  constexpr std::uint64_t kNumberSize[] = {0, sizeof(float), sizeof(double), 1};
  std::uint64_t size = round_up(sizeof(simvis_slot), kCacheLine);
  std::array<std::uint64_t, SIMVIS_SHM_MAX_OUTPUTS> offsets{}, bytes{};
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    offsets[i] = size;
    bytes[i] = std::uint64_t{outputs[i].rows} * outputs[i].columns * outputs[i].channels * kNumberSize[outputs[i].type];
    size = round_up(size + bytes[i], kCacheLine);
  }
  if (size > own.slot_size) {
    const std::uint64_t measurements = own.measurement;
    free_slots(sensor);
    own.measurement = measurements;
    own.slot_size = round_up(size, kPage);
    own.slots_offset = take_slots(own.slot_size * kSlots);
    store(shared.slot_size, own.slot_size);
    store(shared.slots_offset, own.slots_offset);
  }
  const std::uint64_t number = own.measurement + 1;
  unsigned char* const start = object_->at(own.slots_offset + own.measurement % kSlots * own.slot_size);
  auto& slot = *reinterpret_cast<simvis_slot*>(start);
  store_relaxed(slot.sequence, 2 * ++publications_ - 1);
  std::atomic_thread_fence(std::memory_order_release);
  slot.measurement = number;
  slot.frame = frame;
  slot.time_ns = time_ns;
  std::ranges::copy(world_from_sensor, slot.world_from_sensor);
  slot.output_count = static_cast<std::uint32_t>(outputs.size());
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    simvis_output& output = slot.outputs[i];
    output = {};
    outputs[i].name.copy(output.name, sizeof output.name - 1);
    output.offset = offsets[i];
    output.rows = outputs[i].rows;
    output.columns = outputs[i].columns;
    output.channels = outputs[i].channels;
    output.type = outputs[i].type;
    if (bytes[i] > 0) std::memcpy(start + offsets[i], outputs[i].data, bytes[i]);
  }
  store(slot.sequence, 2 * publications_);
  own.measurement = number;
  store(shared.measurement, number);
}

void SharedHost::finish_frame(std::uint64_t next_frame, std::int64_t time_ns) {
  simvis_header& header = object_->shared();
  store_relaxed(header.frame_sequence, ++frame_sequence_);
  std::atomic_thread_fence(std::memory_order_release);
  auto* const applied = reinterpret_cast<std::uint64_t*>(object_->at(object_->layout().applied.offset));
  for (std::size_t i = 0; i < values_.size(); ++i) store_relaxed(applied[i], bits_of(values_[i]));
  store_relaxed(header.frame, ++frames_);
  store_relaxed(header.next_frame, next_frame_ = next_frame);
  store_relaxed(header.time_ns, time_ns);
  store(header.frame_sequence, ++frame_sequence_);
  object_->wake_frame();
}

namespace {

bool has_name(const simvis_client_area& area, std::string_view name) {
  char copy[SIMVIS_SHM_MAX_NAME + 1] = {};
  std::memcpy(copy, area.name, SIMVIS_SHM_MAX_NAME);
  return name == copy;
}

}  // namespace

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
