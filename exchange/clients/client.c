#define _GNU_SOURCE
#include <simvis_client/client.h>

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <linux/futex.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

#define GROUP_TRIES 1000 /* while the host writes: its writes take microseconds */
#define POLL_NS 20000000 /* 20 ms: how often a missing or killed host is looked for */
#define ANSWER_S 5       /* a host that answers later is an error */

/* A region as it was when it was checked: what the shared header says of it may change. */
struct table {
  uint64_t offset, stride, capacity;
  const uint64_t* count; /* shared */
};

struct simvis_client {
  char name[SIMVIS_SHM_MAX_NAME], own_name[SIMVIS_SHM_MAX_NAME];
  int file;
  unsigned char* memory;
  uint64_t size;
  struct simvis_header* header;
  struct table elements, parameters, values, applied, strings, log, sensors;
  uint64_t clients_offset;
  struct simvis_client_area* area;
  uint64_t groups;                      /* in use; the shared count may be damaged by other clients */
  uint64_t group_of[SIMVIS_SHM_GROUPS]; /* the element of each of them */
  uint64_t requests;
};

static _Thread_local char error_text[256];
static _Thread_local int is_missing;

const char* simvis_client_error(void) { return error_text; }
int simvis_is_missing(void) { return is_missing; }

static void fail(const char* format, ...) {
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(error_text, sizeof error_text, format, arguments);
  va_end(arguments);
}

static uint64_t load(const uint64_t* word) { return __atomic_load_n(word, __ATOMIC_ACQUIRE); }
static void store(uint64_t* word, uint64_t value) { __atomic_store_n(word, value, __ATOMIC_RELEASE); }

static int64_t now_ns(void) {
  struct timespec time;
  clock_gettime(CLOCK_MONOTONIC, &time);
  return time.tv_sec * INT64_C(1000000000) + time.tv_nsec;
}

static int set_lock(int file, uint64_t byte) {
  struct flock lock = {.l_type = F_WRLCK, .l_whence = SEEK_SET, .l_start = (off_t)byte, .l_len = 1};
  return fcntl(file, F_OFD_SETLK, &lock);
}

static void unlock_all(int file) {
  struct flock lock = {.l_type = F_UNLCK, .l_whence = SEEK_SET, .l_start = 0, .l_len = 0};
  fcntl(file, F_OFD_SETLK, &lock);
}

static int is_locked(int file, uint64_t byte) {
  struct flock lock = {.l_type = F_WRLCK, .l_whence = SEEK_SET, .l_start = (off_t)byte, .l_len = 1};
  return fcntl(file, F_OFD_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
}

/* Takes the region as it is now, and says whether it lies within the memory. */
static int take_table(const simvis_client* client, const struct simvis_region* region, uint64_t stride,
                      struct table* table) {
  table->offset = load(&region->offset);
  table->stride = load(&region->stride);
  table->capacity = load(&region->capacity);
  table->count = &region->count;
  return table->stride == stride && table->offset % sizeof(uint64_t) == 0 && table->offset <= client->size &&
         table->capacity <= (client->size - table->offset) / stride;
}

static int take_layout(simvis_client* client) {
  const struct simvis_header* const header = client->header;
  const uint64_t areas = SIMVIS_SHM_CLIENTS * sizeof(struct simvis_client_area);
  client->clients_offset = load(&header->clients_offset);
  return header->magic == SIMVIS_SHM_MAGIC && header->version == SIMVIS_SHM_VERSION &&
         header->header_size == sizeof *header && header->total_size == client->size && client->size >= areas &&
         client->clients_offset <= client->size - areas && client->clients_offset % sizeof(uint64_t) == 0 &&
         take_table(client, &header->elements, sizeof(struct simvis_element), &client->elements) &&
         take_table(client, &header->parameters, sizeof(struct simvis_parameter), &client->parameters) &&
         take_table(client, &header->values, sizeof(double), &client->values) &&
         take_table(client, &header->applied, sizeof(double), &client->applied) &&
         take_table(client, &header->strings, 1, &client->strings) &&
         take_table(client, &header->log, 1, &client->log) &&
         take_table(client, &header->sensors, sizeof(struct simvis_sensor), &client->sensors);
}

/* Whether the process that listens at the socket may give commands to this one. Anyone may take a name first, and
 * followers execute what the memory says. */
static int is_trusted(int host, const char* name) {
  const uid_t user = geteuid();
  struct ucred owner;
  socklen_t size = sizeof owner;
  if (getsockopt(host, SOL_SOCKET, SO_PEERCRED, &owner, &size) != 0) {
    fail("\"%s\": %s", name, strerror(errno));
    return 0;
  }
  if (owner.uid == user || (user != 0 && owner.gid == getegid())) return 1;
  fail("\"%s\" is served by process %ld of another user (%lu), expected %s", name, (long)owner.pid,
       (unsigned long)owner.uid, user == 0 ? "one of root" : "one of this program's user or effective group");
  return 0;
}

/* A socket to the host, or -1; `*missing` says that there is none (yet). */
static int connect_to_host(const char* name, int* missing) {
  const struct timeval patience = {.tv_sec = ANSWER_S};
  struct sockaddr_un address = {.sun_family = AF_UNIX}; /* the zero in front of the name makes it abstract */
  const int length = snprintf(address.sun_path + 1, sizeof address.sun_path - 1, "%s%s", SIMVIS_SHM_PREFIX, name);
  const int host = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (host >= 0 && setsockopt(host, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience) == 0 &&
      setsockopt(host, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience) == 0 &&
      connect(host, (const struct sockaddr*)&address,
              (socklen_t)(offsetof(struct sockaddr_un, sun_path) + 1 + (size_t)length)) == 0) {
    return host;
  }
  *missing = errno == ECONNREFUSED;
  fail(*missing ? "no simulation is served as \"%s\"" : "\"%s\": %s", name, strerror(errno));
  if (host >= 0) close(host);
  return -1;
}

/* The descriptor that the host sends with one byte, or -1. */
static int receive_object(int host, const char* name) {
  union {
    struct cmsghdr head; /* aligned */
    char bytes[CMSG_SPACE(sizeof(int))];
  } control;
  char content;
  struct iovec part = {.iov_base = &content, .iov_len = sizeof content};
  struct msghdr message = {
      .msg_iov = &part, .msg_iovlen = 1, .msg_control = &control, .msg_controllen = sizeof control};
  const ssize_t size = recvmsg(host, &message, MSG_CMSG_CLOEXEC);
  const struct cmsghdr* const head = size == 1 ? CMSG_FIRSTHDR(&message) : NULL;
  int object = -1;
  if (head != NULL && head->cmsg_level == SOL_SOCKET && head->cmsg_type == SCM_RIGHTS &&
      head->cmsg_len == CMSG_LEN(sizeof object)) {
    memcpy(&object, CMSG_DATA(head), sizeof object);
    return object;
  }
  if (size < 0) {
    fail("\"%s\": its host does not answer: %s", name, strerror(errno));
  } else {
    fail("\"%s\" is served to another user or group", name);
  }
  return -1;
}

/* A descriptor of the object, or -1; `*missing` says that there is no host (yet). */
static int open_object(const char* name, int* missing) {
  const int host = connect_to_host(name, missing);
  if (host < 0) return -1;
  const int object = is_trusted(host, name) ? receive_object(host, name) : -1;
  close(host);
  return object;
}

/* Whether the object can be read safely: no process can make it shorter, and for root, only root can have written it.
 */
static int check_object(const char* name, int file, struct stat* status) {
  const int seals = fcntl(file, F_GET_SEALS);
  if (fstat(file, status) != 0 || seals < 0 || (seals & F_SEAL_SHRINK) == 0 ||
      (uint64_t)status->st_size < sizeof(struct simvis_header)) {
    fail("\"%s\" is no simulation", name);
    return 0;
  }
  if (geteuid() == 0 && (status->st_mode & (S_IRWXG | S_IRWXO)) != 0) {
    fail("\"%s\" is served to a group, expected for root one that root alone can write", name);
    return 0;
  }
  return 1;
}

/* Maps the object, or returns 0; `*missing` says that there is no living host (yet). */
static int map_object(simvis_client* client, const char* name, int* missing) {
  struct stat status;
  *missing = 0;
  client->file = open_object(name, missing);
  if (client->file < 0 || !check_object(name, client->file, &status)) return 0;
  client->size = (uint64_t)status.st_size;
  client->memory = mmap(NULL, client->size, PROT_READ | PROT_WRITE, MAP_SHARED, client->file, 0);
  if (client->memory == MAP_FAILED) {
    client->memory = NULL;
    fail("\"%s\" can't be mapped: %s", name, strerror(errno));
    return 0;
  }
  client->header = (struct simvis_header*)client->memory;
  if (client->header->magic == SIMVIS_SHM_MAGIC && client->header->version != SIMVIS_SHM_VERSION) {
    fail("\"%s\" has layout %u, this client reads layout %u", name, client->header->version, SIMVIS_SHM_VERSION);
    return 0;
  }
  if (!take_layout(client)) {
    fail("\"%s\" is no simulation", name);
    return 0;
  }
  if (!simvis_alive(client)) {
    *missing = 1;
    fail("the host of \"%s\" has ended", name);
    return 0;
  }
  return 1;
}

/* Bytes of requests that the host has taken. */
static uint64_t taken_of(const struct simvis_client_area* area) {
  return load(&area->acknowledged) == load(&area->connection) ? load(&area->request_tail) : 0;
}

/* Whether the host has taken everything that the area's last client wrote. */
static int is_taken(const struct simvis_client_area* area) {
  const uint64_t connection = load(&area->connection);
  return (connection == 0 || load(&area->acknowledged) == connection) &&
         load(&area->request_head) == load(&area->request_tail);
}

/* A free area. The first round skips areas that the host has not read to their end. */
static int take_area(simvis_client* client, const char* name) {
  struct simvis_client_area* areas = (struct simvis_client_area*)(client->memory + client->clients_offset);
  for (unsigned i = 0; i < 2 * SIMVIS_SHM_CLIENTS; ++i) {
    struct simvis_client_area* area = &areas[i % SIMVIS_SHM_CLIENTS];
    if (i < SIMVIS_SHM_CLIENTS && !is_taken(area)) continue;
    if (set_lock(client->file, (uint64_t)((unsigned char*)area - client->memory)) != 0) continue;
    /* Clear what a dead client left; an odd `connection` marks the area as not ready. */
    store(&area->connection, load(&area->connection) | 1);
    store(&area->group_count, 0);
    store(&area->ready_frames, 0);
    store(&area->request_head, 0);
    for (unsigned g = 0; g < SIMVIS_SHM_GROUPS; ++g) store(&area->groups[g].sequence, 0);
    memset(area->name, 0, sizeof area->name);
    memcpy(area->name, name, strlen(name));
    store(&area->connection, load(&area->connection) + 1);
    client->area = area;
    return 1;
  }
  fail("%u clients are connected, no more can be", SIMVIS_SHM_CLIENTS);
  return 0;
}

static void unmap(simvis_client* client) {
  if (client->memory != NULL) munmap(client->memory, client->size);
  if (client->file >= 0) {
    unlock_all(client->file); /* the host, which sent the file, may not have closed its copy yet */
    close(client->file);
  }
  client->memory = NULL;
  client->file = -1;
}

static int is_name(const char* name) {
  const size_t size = strlen(name);
  return size >= 1 && size < SIMVIS_SHM_MAX_NAME &&
         strspn(name, "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-") == size;
}

simvis_client* simvis_connect(const char* name, const char* client_name, int timeout_ms) {
  const int64_t end_ns = now_ns() + timeout_ms * INT64_C(1000000);
  const struct timespec pause = {.tv_sec = 0, .tv_nsec = POLL_NS};
  if (!is_name(name) || !is_name(client_name)) {
    fail("\"%s\": expected 1 to %d of A-Z a-z 0-9 . _ -", is_name(name) ? client_name : name, SIMVIS_SHM_MAX_NAME - 1);
    return NULL;
  }
  simvis_client* const client = calloc(1, sizeof *client);
  if (client == NULL) {
    fail("out of memory");
    return NULL;
  }
  client->file = -1;
  strcpy(client->name, name);
  strcpy(client->own_name, client_name);
  for (;;) {
    int missing = 0;
    is_missing = 0;
    if (map_object(client, name, &missing) && take_area(client, client_name)) return client;
    unmap(client);
    is_missing = missing;
    if (!missing || (timeout_ms >= 0 && now_ns() >= end_ns)) break;
    nanosleep(&pause, NULL);
  }
  free(client);
  return NULL;
}

static void leave(simvis_client* client) {
  if (client->area != NULL) store(&client->area->connection, load(&client->area->connection) | 1);
  unmap(client);
}

void simvis_disconnect(simvis_client* client) {
  if (client == NULL) return;
  leave(client);
  free(client);
}

int simvis_reconnect(simvis_client* client, int timeout_ms) {
  simvis_client* const next = simvis_connect(client->name, client->own_name, timeout_ms);
  if (next == NULL) return -1;
  leave(client);
  *client = *next;
  free(next);
  return 0;
}

int simvis_alive(const simvis_client* client) {
  return __atomic_load_n(&client->header->state, __ATOMIC_ACQUIRE) == SIMVIS_RUNNING &&
         is_locked(client->file, SIMVIS_SHM_LOCK_BYTE);
}

uint32_t simvis_slot_of(const simvis_client* client) {
  const unsigned char* const first = client->memory + client->clients_offset;
  return (uint32_t)(((const unsigned char*)client->area - first) / (ptrdiff_t)sizeof(struct simvis_client_area));
}

uint64_t simvis_generation(const simvis_client* client) { return client->header->generation; }

static uint64_t count_of(const struct table* table) {
  const uint64_t count = load(table->count);
  return count < table->capacity ? count : table->capacity;
}

static const void* entry(const simvis_client* client, const struct table* table, int64_t id) {
  if (id < 0 || (uint64_t)id >= count_of(table)) return NULL;
  return client->memory + table->offset + (uint64_t)id * table->stride;
}

uint64_t simvis_element_count(const simvis_client* client) { return count_of(&client->elements); }
uint64_t simvis_parameter_count(const simvis_client* client) { return count_of(&client->parameters); }
uint64_t simvis_sensor_count(const simvis_client* client) { return count_of(&client->sensors); }

const struct simvis_element* simvis_element_at(const simvis_client* client, int64_t id) {
  return entry(client, &client->elements, id);
}
const struct simvis_parameter* simvis_parameter_at(const simvis_client* client, int64_t id) {
  return entry(client, &client->parameters, id);
}
const struct simvis_sensor* simvis_sensor_at(const simvis_client* client, int64_t id) {
  return entry(client, &client->sensors, id);
}

const char* simvis_text_at(const simvis_client* client, struct simvis_text text) {
  const uint64_t count = count_of(&client->strings);
  if (text.offset > count || text.size > count - text.offset) return NULL;
  return (const char*)client->memory + client->strings.offset + text.offset;
}

static int is_text(const simvis_client* client, struct simvis_text text, const char* seen) {
  const size_t size = strlen(seen);
  const char* const known = text.size == size ? simvis_text_at(client, text) : NULL;
  return known != NULL && memcmp(known, seen, size) == 0;
}

/* The newest first: a name that was taken out and given again means the new one. */
int64_t simvis_find_element(const simvis_client* client, const char* name) {
  for (int64_t id = (int64_t)simvis_element_count(client) - 1; id >= 0; --id) {
    const struct simvis_element* const element = simvis_element_at(client, id);
    if (!__atomic_load_n(&element->removed, __ATOMIC_ACQUIRE) && is_text(client, element->name, name)) return id;
  }
  fail("there is no element \"%s\"", name);
  return -1;
}

int64_t simvis_find_parameter(const simvis_client* client, const char* element_name, const char* name) {
  const struct simvis_element* const element = simvis_element_at(client, simvis_find_element(client, element_name));
  if (element == NULL) return -1;
  for (uint32_t i = 0; i < element->parameter_count; ++i) {
    const int64_t id = (int64_t)(element->first_parameter + i);
    const struct simvis_parameter* const parameter = simvis_parameter_at(client, id);
    if (parameter == NULL) break;
    if (is_text(client, parameter->name, name)) return id;
  }
  fail("element \"%s\" has no parameter \"%s\"", element_name, name);
  return -1;
}

int64_t simvis_find_sensor(const simvis_client* client, const char* name) {
  for (int64_t id = (int64_t)simvis_sensor_count(client) - 1; id >= 0; --id) {
    const struct simvis_sensor* const sensor = simvis_sensor_at(client, id);
    if (!__atomic_load_n(&sensor->removed, __ATOMIC_ACQUIRE) && is_text(client, sensor->name, name)) return id;
  }
  fail("there is no sensor \"%s\"", name);
  return -1;
}

double simvis_get(const simvis_client* client, int64_t parameter) {
  const uint64_t* const word = entry(client, &client->values, parameter);
  const uint64_t bits = word == NULL ? UINT64_C(0x7ff8000000000000) : __atomic_load_n(word, __ATOMIC_RELAXED);
  double value;
  memcpy(&value, &bits, sizeof value);
  return value;
}

int simvis_set(simvis_client* client, int64_t parameter, double value) {
  uint64_t* const word = (uint64_t*)(uintptr_t)entry(client, &client->values, parameter);
  uint64_t bits;
  if (word == NULL) {
    fail("there is no parameter of id %lld", (long long)parameter);
    return -1;
  }
  memcpy(&bits, &value, sizeof bits);
  __atomic_store_n(word, bits, __ATOMIC_RELAXED);
  return 0;
}

static struct simvis_group* group_of(simvis_client* client, uint64_t element) {
  for (uint64_t g = 0; g < client->groups; ++g) {
    if (client->group_of[g] == element) return &client->area->groups[g];
  }
  if (client->groups == SIMVIS_SHM_GROUPS) return NULL;
  client->group_of[client->groups] = element;
  store(&client->area->group_count, client->groups + 1);
  return &client->area->groups[client->groups++];
}

int simvis_set_element(simvis_client* client, int64_t id, const double* values, size_t count) {
  const struct simvis_element* const element = simvis_element_at(client, id);
  if (element == NULL || element->parameter_count != count || count > SIMVIS_SHM_GROUP_VALUES) {
    fail(element == NULL ? "there is no element of id %lld"
                         : "element %lld has another number of parameters, or too many",
         (long long)id);
    return -1;
  }
  struct simvis_group* const group = group_of(client, (uint64_t)id);
  if (group == NULL) {
    fail("a client writes at most %d elements as a whole", SIMVIS_SHM_GROUPS);
    return -1;
  }
  const uint64_t sequence = group->sequence;
  __atomic_store_n(&group->sequence, sequence + 1, __ATOMIC_RELAXED);
  __atomic_thread_fence(__ATOMIC_RELEASE);
  __atomic_store_n(&group->element, (uint64_t)id, __ATOMIC_RELAXED);
  for (size_t i = 0; i < count; ++i) {
    uint64_t bits;
    memcpy(&bits, &values[i], sizeof bits);
    __atomic_store_n((uint64_t*)&group->values[i], bits, __ATOMIC_RELAXED);
  }
  store(&group->sequence, sequence + 2);
  return 0;
}

int64_t simvis_applied(const simvis_client* client, uint64_t first, double* values, size_t count) {
  struct simvis_frame_info frame;
  return simvis_applied_frame(client, first, values, count, &frame) == 0 ? (int64_t)frame.frames : -1;
}

int simvis_applied_frame(const simvis_client* client, uint64_t first, double* values, size_t count,
                         struct simvis_frame_info* frame) {
  const struct simvis_header* const header = client->header;
  const uint64_t known = count_of(&client->applied);
  const uint64_t* const words = (const uint64_t*)(client->memory + client->applied.offset);
  if (first > known || count > known - first) {
    fail("there are %llu parameters", (unsigned long long)known);
    return -1;
  }
  for (int tries = 0; tries < GROUP_TRIES; ++tries) {
    const uint64_t sequence = load(&header->frame_sequence);
    if (sequence % 2 == 0) {
      for (size_t i = 0; i < count; ++i) {
        const uint64_t bits = __atomic_load_n(&words[first + i], __ATOMIC_RELAXED);
        memcpy(&values[i], &bits, sizeof bits);
      }
      frame->frames = __atomic_load_n(&header->frame, __ATOMIC_RELAXED);
      frame->next_frame = __atomic_load_n(&header->next_frame, __ATOMIC_RELAXED);
      frame->time_ns = __atomic_load_n(&header->time_ns, __ATOMIC_RELAXED);
      __atomic_thread_fence(__ATOMIC_ACQUIRE);
      if (__atomic_load_n(&header->frame_sequence, __ATOMIC_RELAXED) == sequence) return 0;
    }
    const struct timespec pause = {.tv_sec = 0, .tv_nsec = 10000};
    nanosleep(&pause, NULL);
  }
  fail("the host was killed while it wrote a frame");
  return -1;
}

static void copy_in(unsigned char* ring, uint64_t at, const void* bytes, uint64_t size) {
  const uint64_t start = at % SIMVIS_SHM_REQUEST_BYTES;
  const uint64_t first = size < SIMVIS_SHM_REQUEST_BYTES - start ? size : SIMVIS_SHM_REQUEST_BYTES - start;
  memcpy(ring + start, bytes, first);
  memcpy(ring, (const unsigned char*)bytes + first, size - first);
}

uint64_t simvis_send(simvis_client* client, const char* xml) {
  struct simvis_client_area* const area = client->area;
  const uint64_t size = strlen(xml), whole = sizeof(struct simvis_request) + (size + 7) / 8 * 8;
  const uint64_t head = load(&area->request_head), used = head - taken_of(area);
  if (whole > SIMVIS_SHM_REQUEST_BYTES) {
    fail("a request has at most %d bytes", (int)(SIMVIS_SHM_REQUEST_BYTES - sizeof(struct simvis_request)));
    return 0;
  }
  if (used > SIMVIS_SHM_REQUEST_BYTES || whole > SIMVIS_SHM_REQUEST_BYTES - used) {
    fail("the host has not taken the earlier requests yet");
    return 0;
  }
  const struct simvis_request request = {.number = client->requests + 1, .size = size};
  copy_in(area->requests, head, &request, sizeof request);
  copy_in(area->requests, head + sizeof request, xml, size);
  store(&area->request_head, head + whole);
  return ++client->requests;
}

const struct simvis_log_entry* simvis_next_log(const simvis_client* client, uint64_t* position, const char** text) {
  const uint64_t count = count_of(&client->log);
  if (*position >= count || count - *position < sizeof(struct simvis_log_entry)) return NULL;
  const struct simvis_log_entry* const found =
      (const struct simvis_log_entry*)(client->memory + client->log.offset + *position);
  const uint64_t size = __atomic_load_n(&found->size, __ATOMIC_RELAXED);
  if (size < sizeof *found || size % sizeof(uint64_t) != 0 || size > count - *position ||
      __atomic_load_n(&found->text_size, __ATOMIC_RELAXED) > size - sizeof *found) {
    return NULL;
  }
  if (text != NULL) *text = (const char*)(found + 1);
  *position += size;
  return found;
}

int simvis_latest(const simvis_client* client, int64_t id, struct simvis_view* view) {
  const struct simvis_sensor* const sensor = simvis_sensor_at(client, id);
  if (sensor == NULL) {
    fail("there is no sensor of id %lld", (long long)id);
    return -1;
  }
  int tries = 0;
  for (; tries < GROUP_TRIES; ++tries) {
    const uint64_t number = load(&sensor->measurement), offset = load(&sensor->slots_offset);
    const uint64_t slots = __atomic_load_n(&sensor->slot_count, __ATOMIC_RELAXED), size = load(&sensor->slot_size);
    if (number == 0 || slots == 0) break;
    if (offset > client->size || size < sizeof(struct simvis_slot) || slots > (client->size - offset) / size) break;
    if (offset % sizeof(uint64_t) != 0 || size % sizeof(uint64_t) != 0) break;
    const struct simvis_slot* const slot =
        (const struct simvis_slot*)(client->memory + offset + (number - 1) % slots * size);
    view->slot = slot;
    view->slot_size = size;
    view->sequence = load(&slot->sequence);
    if (view->sequence % 2 == 0 && slot->measurement == number && simvis_view_is_whole(view)) return 0;
  }
  fail(tries < GROUP_TRIES ? "the sensor has not measured yet" : "the host writes faster than this program reads");
  return -1;
}

const struct simvis_output* simvis_output_at(const struct simvis_view* view, uint32_t index) {
  const uint64_t fit = (view->slot_size - sizeof(struct simvis_slot)) / sizeof(struct simvis_output);
  if (index >= view->slot->output_count || index >= fit) return NULL;
  return (const struct simvis_output*)(view->slot + 1) + index;
}

/* A text within the slot, whatever the host writes there meanwhile. */
static const char* slot_text(const struct simvis_view* view, uint32_t offset, uint32_t size) {
  if (offset >= view->slot_size || size >= view->slot_size - offset) return NULL;
  const char* const text = (const char*)view->slot + offset;
  return text[size] == 0 ? text : NULL;
}

const char* simvis_output_name(const struct simvis_view* view, const struct simvis_output* output) {
  return slot_text(view, output->name_offset, output->name_size);
}

const char* simvis_output_unit(const struct simvis_view* view, const struct simvis_output* output) {
  return slot_text(view, output->unit_offset, output->unit_size);
}

static uint64_t number_bytes(uint32_t type) {
  switch (type) {
    case SIMVIS_UINT8:
      return 1;
    case SIMVIS_FLOAT32:
    case SIMVIS_UINT32:
    case SIMVIS_INT32:
      return 4;
    case SIMVIS_FLOAT64:
      return 8;
    default:
      return 0;
  }
}

/* Whether the numbers of this copy lie within the slot. */
static int numbers_fit(const struct simvis_view* view, const struct simvis_output* output) {
  const uint64_t bytes = number_bytes(output->type), places = (uint64_t)output->rows * output->columns;
  if (bytes == 0 || output->offset > view->slot_size || output->offset % sizeof(uint64_t) != 0) return 0;
  return output->channels == 0 || places <= (view->slot_size - output->offset) / bytes / output->channels;
}

int simvis_copy_output(const struct simvis_view* view, uint32_t index, struct simvis_output* output) {
  const struct simvis_output* const shared = simvis_output_at(view, index);
  if (shared == NULL) {
    fail("the measurement has no output %u", index);
    return -1;
  }
  memcpy(output, shared, sizeof *output);
  __atomic_signal_fence(__ATOMIC_SEQ_CST); /* what follows reads the copy alone */
  if (simvis_output_name(view, output) == NULL || simvis_output_unit(view, output) == NULL ||
      !numbers_fit(view, output)) {
    fail("output %u does not lie within the measurement", index);
    return -1;
  }
  return 0;
}

const void* simvis_output_data(const struct simvis_view* view, const char* name, const struct simvis_output** output) {
  const size_t size = strlen(name);
  const struct simvis_output* each;
  for (uint32_t i = 0; (each = simvis_output_at(view, i)) != NULL; ++i) {
    struct simvis_output copy;
    const unsigned char* const slot = (const unsigned char*)view->slot;
    if (simvis_copy_output(view, i, &copy) != 0 || copy.name_size != size) continue;
    if (memcmp(slot + copy.name_offset, name, size) != 0) continue;
    if (output != NULL) *output = each;
    return slot + copy.offset;
  }
  fail("the measurement has no output \"%s\"", name);
  return NULL;
}

int simvis_view_is_whole(const struct simvis_view* view) {
  __atomic_thread_fence(__ATOMIC_ACQUIRE);
  return __atomic_load_n(&view->slot->sequence, __ATOMIC_RELAXED) == view->sequence;
}

uint64_t simvis_frame(const simvis_client* client) { return load(&client->header->frame); }

int64_t simvis_time_ns(const simvis_client* client) {
  return __atomic_load_n(&client->header->time_ns, __ATOMIC_ACQUIRE);
}

/* A killed host wakes no client, so a wait ends every POLL_NS to check whether the host lives. */
int simvis_wait_frame(const simvis_client* client, uint64_t frames, int timeout_ms) {
  const int64_t end_ns = now_ns() + timeout_ms * INT64_C(1000000);
  for (;;) {
    const uint32_t seen = __atomic_load_n(&client->header->frame_futex, __ATOMIC_ACQUIRE);
    if (simvis_frame(client) > frames) return 1;
    if (!simvis_alive(client)) {
      fail("the host is gone");
      return -1;
    }
    int64_t rest_ns = POLL_NS;
    if (timeout_ms >= 0) {
      const int64_t left_ns = end_ns - now_ns();
      if (left_ns <= 0) return 0;
      if (left_ns < rest_ns) rest_ns = left_ns;
    }
    const struct timespec rest = {.tv_sec = 0, .tv_nsec = rest_ns};
    syscall(SYS_futex, &client->header->frame_futex, FUTEX_WAIT, seen, &rest, NULL, 0);
  }
}

int simvis_ready(simvis_client* client) {
  if (!simvis_alive(client)) {
    fail("the host is gone");
    return -1;
  }
  store(&client->area->ready_frames, load(&client->header->next_frame) + 1);
  __atomic_fetch_add(&client->header->ready_futex, 1, __ATOMIC_RELEASE);
  syscall(SYS_futex, &client->header->ready_futex, FUTEX_WAKE, INT_MAX, NULL, NULL, 0);
  return 0;
}
