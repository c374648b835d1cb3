/* The layout of a running simulation in POSIX shared memory. This header is the format: docs/shared-memory.md explains
 * it, and the host and every client are written against it. C11 or C++; no dependency.
 *
 * Object    a memfd that is sealed against shrinking and growing, so no process can make another one fail by
 *           truncation. Clients receive it, as one descriptor with one byte, from the abstract Unix socket
 *           "simvis-NAME" (SOCK_STREAM), which the host opens when the object is complete: clients see it whole or not
 *           at all. The host sends it to programs of its user, and, where it is served to the group, to those with its
 *           effective group. A client checks who listens (SO_PEERCRED) before it receives anything: anyone may take a
 *           name. It accepts its own user and, unless it is root, its own effective group; root also refuses what is
 *           served to a group (mode 0660 of the object in place of 0600).
 * Writers   each byte has one kind of writer. `values` may be written by the host and all clients, each double by one
 * atomic store. A client writes its own client_area beside that. Everything else is written by the host alone, which
 * never reads it back: a client that damages it harms other clients, not the host. Atomics   fields marked "atomic" are
 * read with acquire order and written with release order. A "sequence" is odd while its owner writes what it guards: a
 * reader reads the sequence, the data and the sequence again, and keeps the data only if both were equal and even.
 * Growth    tables only grow. What was removed keeps its entry, with `removed` set; ids are never given away again.
 * Offsets   bytes from the start of the object. Strings are UTF-8 without a terminating zero, at an offset from
 *           `strings.offset`.
 * Units     as the elements' tables say: metres, degrees. Times in nanoseconds. Native byte order.
 */
#ifndef SIMVIS_SHARED_MEMORY_H
#define SIMVIS_SHARED_MEMORY_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define SIMVIS_SHM_MAGIC UINT64_C(0x314d4d48534d5653) /**< "SVMSHMM1" as bytes in memory */
#define SIMVIS_SHM_VERSION 2u                         /**< another number is another layout */
#define SIMVIS_SHM_PREFIX "simvis-"                   /**< of the socket's abstract name */
#define SIMVIS_SHM_MAX_NAME 64                        /**< of NAME: A-Z a-z 0-9 . _ - */

#define SIMVIS_SHM_LOCK_BYTE 0 /**< the host holds an OFD write lock on this byte of the object while it lives */

#define SIMVIS_SHM_CLIENTS 32           /**< connected at a time */
#define SIMVIS_SHM_GROUPS 512           /**< elements that one client writes as a whole */
#define SIMVIS_SHM_GROUP_VALUES 16      /**< parameters of such an element at most */
#define SIMVIS_SHM_REQUEST_BYTES 131072 /**< of a client's request ring; a power of two */

/** A string. */
struct simvis_text {
  uint64_t offset; /**< from strings.offset */
  uint64_t size;   /**< bytes */
};

/** A table or an area of bytes. */
struct simvis_region {
  uint64_t offset;   /**< of its first entry */
  uint64_t stride;   /**< bytes of an entry; 1: bytes */
  uint64_t capacity; /**< entries that fit */
  uint64_t count;    /**< atomic: entries that are there and complete */
};

/** Whether the host lives. */
enum simvis_state {
  SIMVIS_RUNNING = 1, /**< the host lives, or was killed: see SIMVIS_SHM_LOCK_BYTE */
  SIMVIS_ENDED = 2    /**< the host ended in an orderly way; nothing changes any more */
};

/** The start of the object; written by the host. */
struct simvis_header {
  uint64_t magic;                  /**< SIMVIS_SHM_MAGIC */
  uint32_t version;                /**< SIMVIS_SHM_VERSION */
  uint32_t header_size;            /**< sizeof(struct simvis_header) */
  uint64_t generation;             /**< a random number of this run of the host: another one is another run */
  int64_t host_pid;                /**< for people; processes in other namespaces know it by another number */
  uint64_t total_size;             /**< bytes of the object; most of them take no memory before they are used */
  uint64_t clients_offset;         /**< of SIMVIS_SHM_CLIENTS entries of struct simvis_client_area */
  struct simvis_region elements;   /**< struct simvis_element; the index is the element's id */
  struct simvis_region parameters; /**< struct simvis_parameter; the index is the parameter's id */
  struct simvis_region values;     /**< double by parameter id: write here what a parameter shall be */
  struct simvis_region
      applied; /**< double by parameter id: what frame `frame` was made with; guarded by frame_sequence */
  struct simvis_region strings; /**< bytes */
  struct simvis_region log;     /**< bytes: entries of struct simvis_log_entry, one after the other */
  struct simvis_region sensors; /**< struct simvis_sensor; the index is the sensor's id */
  struct simvis_region outputs; /**< bytes: slots of measurements */
  uint32_t ready_futex;         /**< atomic; written by clients: changes when one says that it is ready (lock-step) */
  uint32_t reserved32;          /**< 0 */
  uint64_t reserved[7];         /**< 0 */
  /** What changes with each frame stands in cache lines of its own. */
  uint64_t frame_sequence; /**< sequence of `applied`, `frame`, `next_frame` and `time_ns` */
  uint64_t frame;          /**< number of frames that were finished since the host began to serve */
  uint64_t next_frame;     /**< index of the frame that the host makes next */
  int64_t time_ns;         /**< simulated time of the last finished frame; 0 before the first */
  uint32_t frame_futex;    /**< atomic: changes with each finished frame and at the end; wait for it with FUTEX_WAIT */
  uint32_t state;          /**< atomic: enum simvis_state */
  uint64_t frame_padding[3]; /**< 0 */
};

/** An element: an object whose parameters can be changed. */
struct simvis_element {
  struct simvis_text name;            /**< the element's name */
  struct simvis_text type;            /**< its type */
  struct simvis_text insertion_point; /**< where it was inserted */
  uint64_t first_parameter;           /**< id of its first parameter; the others follow */
  uint32_t parameter_count;           /**< how many parameters it has */
  uint32_t removed;                   /**< atomic: 0 or 1 */
};

/** Limits that are not allowed themselves. */
enum simvis_parameter_flags {
  SIMVIS_OPEN_MIN = 1, /**< `min` itself is not allowed */
  SIMVIS_OPEN_MAX = 2  /**< `max` itself is not allowed */
};

/** A number that clients can set. */
struct simvis_parameter {
  struct simvis_text name; /**< the parameter's name */
  struct simvis_text unit; /**< "m", "deg"; may be empty */
  double min;              /**< smallest value; infinite: no limit */
  double max;              /**< largest value; infinite: no limit */
  uint64_t element;        /**< id of its element */
  uint32_t flags;          /**< enum simvis_parameter_flags */
  uint32_t reserved;       /**< 0 */
};

/** What an entry of the log says. */
enum simvis_log_kind {
  SIMVIS_CHANGE =
      1, /**< text: a command that was executed, in the form of a scene file; replaying all makes the scene */
  SIMVIS_REQUEST_DONE = 2,    /**< request `request` of client `client` was executed as a whole */
  SIMVIS_REQUEST_REFUSED = 3, /**< it was refused as a whole; text: why */
  SIMVIS_VALUE_REFUSED = 4,   /**< a value that a client wrote was refused and the old one kept; text: which and why */
  SIMVIS_CLIENT_REFUSED = 5   /**< what a client's area holds makes no sense and is ignored; text: what */
};

/** An entry of the log, followed by `text_size` bytes and filled up to a multiple of 8 bytes. */
struct simvis_log_entry {
  uint32_t size;      /**< bytes of the whole entry */
  uint32_t kind;      /**< enum simvis_log_kind; skip kinds that you do not know */
  uint64_t request;   /**< number of the request; 0: none */
  uint32_t client;    /**< slot of the client */
  uint32_t text_size; /**< bytes of the text */
  uint64_t frame;     /**< index of the first frame that is made with it */
};

/** The type of the numbers of an output. */
enum simvis_number_type {
  SIMVIS_FLOAT32 = 1,
  SIMVIS_FLOAT64 = 2,
  SIMVIS_UINT8 = 3,
  SIMVIS_UINT32 = 4,
  SIMVIS_INT32 = 5
};

/** An array of a measurement: rows x columns x channels numbers without gaps. Offsets are from the start of the slot. A
 * name and a unit end with a zero, which their sizes do not count. */
struct simvis_output {
  uint64_t offset; /**< of the numbers, a multiple of 64 */
  uint32_t
      name_offset;    /**< "range_m", "error_bound_m", "azimuth_rad", "color", "depth", ... as docs/reference.md says */
  uint32_t name_size; /**< bytes */
  uint32_t unit_offset; /**< "m", "rad/s"; empty: none */
  uint32_t unit_size;   /**< bytes */
  uint32_t rows;        /**< of the array */
  uint32_t columns;     /**< of a row */
  uint32_t channels;    /**< numbers of each place */
  uint32_t type;        /**< enum simvis_number_type */
};

/** One measurement of a sensor; its outputs, `output_count` of struct simvis_output, follow it. */
struct simvis_slot {
  uint64_t sequence;            /**< of this slot; no other measurement of any sensor ever has it */
  uint64_t measurement;         /**< its number: 1 for the first one of the sensor */
  uint64_t frame;               /**< index of the frame */
  int64_t time_ns;              /**< simulated time of the measurement */
  double world_from_sensor[16]; /**< column by column; rigid; x forward, y left, z up, metres */
  uint32_t output_count;        /**< how many outputs it has */
  uint32_t reserved;            /**< 0 */
};

/** A sensor. Measurement n lies in slot (n - 1) % slot_count, at slots_offset + that * slot_size. */
struct simvis_sensor {
  struct simvis_text name; /**< the sensor's name */
  struct simvis_text type; /**< its type */
  uint64_t slots_offset;   /**< atomic; 0 before the first measurement */
  uint64_t slot_size;      /**< atomic; 0 before the first measurement */
  uint32_t slot_count;     /**< how many slots are used in turn */
  uint32_t removed;        /**< atomic: 0 or 1 */
  uint64_t measurement;    /**< atomic: number of the latest one; 0 before the first */
};

/** All parameters of one element, written as a whole; written by the client that owns the area. */
struct simvis_group {
  uint64_t sequence;                      /**< of this group */
  uint64_t element;                       /**< id of the element */
  double values[SIMVIS_SHM_GROUP_VALUES]; /**< of its parameters, in their order */
};

/** A request in the ring: this head, then `size` bytes of XML, filled up to a multiple of 8 bytes. */
struct simvis_request {
  uint64_t number; /**< of the client's choice; the log names it */
  uint64_t size;   /**< bytes of the XML */
};

/** A client's area. It belongs to the process that holds an OFD write lock on its first byte; the kernel lets go of the
 * lock when that process ends in whatever way. */
struct simvis_client_area {
  uint64_t connection; /**< atomic: 0 or odd: no client; a new client writes an even number that was not there before,
                        * last; the next odd one when it leaves */
  char name[SIMVIS_SHM_MAX_NAME]; /**< for people and for lock-step; zero-terminated */
  uint64_t ready_frames;          /**< atomic: lock-step: the client is ready for all frames below this index */
  uint64_t request_head;          /**< atomic: bytes that this connection ever put into the ring */
  uint64_t group_count;           /**< atomic: groups that are in use */
  uint64_t padding_of_client[19]; /**< 0 */
  uint64_t acknowledged; /**< atomic; written by the host: the connection that request_tail speaks of; odd: the client
                          * has left, and all that it wrote is taken */
  uint64_t request_tail; /**< atomic; written by the host: bytes that it took from the ring; 0 for another connection */
  uint64_t padding_of_host[14];                  /**< 0 */
  struct simvis_group groups[SIMVIS_SHM_GROUPS]; /**< elements that the client writes as a whole */
  uint8_t requests[SIMVIS_SHM_REQUEST_BYTES];    /**< the ring of struct simvis_request */
};

#ifdef __cplusplus
}
#endif
#endif
