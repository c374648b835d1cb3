/* Reads and writes a running simulation from another process. C11, no dependency but POSIX; connection.h wraps it for
 * C++.
 *
 * Units     those of the elements' tables: metres, degrees. Simulated times in nanoseconds.
 * Errors    a call that fails returns -1, 0 or NULL as it says, and simvis_client_error() then gives the reason.
 * Lifetime  pointers and views that calls return are valid until simvis_disconnect().
 * Threads   one thread at a time for each connection; a process may have several connections.
 * Costs     after the look-up of an id, setting and getting a value is one access to memory: no system call, no lock.
 */
#ifndef SIMVIS_CLIENT_H
#define SIMVIS_CLIENT_H

#include <stddef.h>
#include <stdint.h>

#include <simvis_client/shared_memory.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct simvis_client simvis_client;

/** Connects to the simulation that is served as `name`, and waits for it up to `timeout_ms` (0: not at all; negative:
 * for ever). `client` is this program's name, for people and for lock-step. NULL: see the error. */
simvis_client* simvis_connect(const char* name, const char* client, int timeout_ms);
void simvis_disconnect(simvis_client* client); /**< NULL is allowed */

/** Connects to the host that has the name now, after the present one has ended: waits for it as simvis_connect().
 * Pointers, views and ids of before are then invalid, and positions in the log begin at 0. Returns 0; -1: there is none
 * in time, and the connection is as it was. */
int simvis_reconnect(simvis_client* client, int timeout_ms);

/** Why the last call of this thread failed; never NULL. */
const char* simvis_client_error(void);
/** 1: the last simvis_connect() of this thread failed because there is no such host (yet), or it has ended. */
int simvis_is_missing(void);

/** 1: the host lives. 0: it ended or was killed; values, results and the log stay readable as they stood.
 * simvis_reconnect() finds its successor. */
int simvis_alive(const simvis_client* client);
/** The number by which entries of the log name this client. */
uint32_t simvis_slot_of(const simvis_client* client);
/** A random number of the host's run. */
uint64_t simvis_generation(const simvis_client* client);

/** The id of an element, parameter or sensor that is not removed, or -1. Ids are the same as long as the host lives. */
int64_t simvis_find_element(const simvis_client* client, const char* name);
int64_t simvis_find_parameter(const simvis_client* client, const char* element, const char* parameter);
int64_t simvis_find_sensor(const simvis_client* client, const char* name);

/** How many there are, removed ones included, and the entry of an id; NULL: there is no such id. */
uint64_t simvis_element_count(const simvis_client* client);
uint64_t simvis_parameter_count(const simvis_client* client);
uint64_t simvis_sensor_count(const simvis_client* client);
const struct simvis_element* simvis_element_at(const simvis_client* client, int64_t id);
const struct simvis_parameter* simvis_parameter_at(const simvis_client* client, int64_t id);
const struct simvis_sensor* simvis_sensor_at(const simvis_client* client, int64_t id);
/** The bytes of a text, `text.size` of them without a terminating zero. NULL: the host's memory is damaged, and holds
 * no such text. */
const char* simvis_text_at(const simvis_client* client, struct simvis_text text);

/** The value of a parameter as it stands, NaN for an unknown id. */
double simvis_get(const simvis_client* client, int64_t parameter);
/** Sets it: in force from the next frame that the host begins. A value out of range is refused in the log, and the old
 * one comes back. Returns 0, or -1 for an unknown id. */
int simvis_set(simvis_client* client, int64_t parameter, double value);
/** Sets all `count` parameters of an element at once: no frame sees a part of them. `count` is the element's number of
 * parameters, at most SIMVIS_SHM_GROUP_VALUES. If several clients write the same element, the client with the higher
 * slot wins within a frame. Returns 0 or -1. */
int simvis_set_element(simvis_client* client, int64_t element, const double* values, size_t count);
/** Copies what the last finished frame was made with, all of one frame: `values[i]` is parameter `first + i`. Returns
 * the number of finished frames, or -1: there are no such parameters, or the host was killed while it wrote. */
int64_t simvis_applied(const simvis_client* client, uint64_t first, double* values, size_t count);

/** Of the last finished frame. */
struct simvis_frame_info {
  uint64_t frames;     /**< number of finished frames */
  uint64_t next_frame; /**< index of the frame that follows it: entries of the log with a smaller one are all there */
  int64_t time_ns;     /**< its simulated time */
};
/** As simvis_applied(), with what else belongs to that frame. Returns 0 or -1. */
int simvis_applied_frame(const simvis_client* client, uint64_t first, double* values, size_t count,
                         struct simvis_frame_info* frame);

/** Appends a change request: XML commands as in a scene file. The host executes it as a whole or refuses it as a whole
 * before its next frame, and says so in the log with this number. Returns the number, or 0: too long, or the host has
 * not yet taken enough of the earlier ones. */
uint64_t simvis_send(simvis_client* client, const char* xml);

/** The entry of the log at `*position`, which begins at 0 and is moved to the next entry. `*text` points to the entry's
 * text. NULL: there is none yet. */
const struct simvis_log_entry* simvis_next_log(const simvis_client* client, uint64_t* position, const char** text);

/** A measurement in shared memory, not copied. */
struct simvis_view {
  const struct simvis_slot* slot; /**< frame, time, pose */
  uint64_t sequence;              /**< of the slot when the view was taken */
  uint64_t slot_size;             /**< bytes of the slot */
};
/** The latest measurement of a sensor. Returns 0, or -1: no such sensor, or no measurement yet. */
int simvis_latest(const simvis_client* client, int64_t sensor, struct simvis_view* view);
/** The output of this index, below slot->output_count; NULL: there is none, or the host has begun to write over the
 * view. */
const struct simvis_output* simvis_output_at(const struct simvis_view* view, uint32_t index);

/** Its name and its unit, which end with a zero; a unit may be empty. NULL: the host has begun to write over the view.
 */
const char* simvis_output_name(const struct simvis_view* view, const struct simvis_output* output);
const char* simvis_output_unit(const struct simvis_view* view, const struct simvis_output* output);

/** A copy of the output of this index, which the host cannot change: its name, its unit and its numbers lie within the
 * slot, at their offsets from view->slot, whatever the host writes. Returns 0, or -1: there is none, or it does not lie
 * within the slot. */
int simvis_copy_output(const struct simvis_view* view, uint32_t index, struct simvis_output* output);

/** The numbers of an output of the view, or NULL if it has none of this name whose numbers lie within the slot;
 * `*output` is set if it is not NULL. Where the host is not trusted, count the numbers by simvis_copy_output(). */
const void* simvis_output_data(const struct simvis_view* view, const char* name, const struct simvis_output** output);
/** 1: what was read from the view so far was whole. 0: the host has begun to write over it; read the latest one again.
 */
int simvis_view_is_whole(const struct simvis_view* view);

/** The number of frames that the host has finished, and the simulated time of the last one. */
uint64_t simvis_frame(const simvis_client* client);
int64_t simvis_time_ns(const simvis_client* client);
/** Waits until the host has finished more than `frames` frames, up to `timeout_ms` (negative: for ever). Returns 1; 0:
 * the time is over; -1: the host is gone. */
int simvis_wait_frame(const simvis_client* client, uint64_t frames, int timeout_ms);
/** Lock-step: the host may make the frame that it makes next. Returns 0, or -1 if the host is gone. */
int simvis_ready(simvis_client* client);

#ifdef __cplusplus
}
#endif
#endif
