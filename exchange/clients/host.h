// The host's side of the shared memory: makes the object, fills its tables, and reads what clients wrote.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/measurement.h>
#include <simvis_client/shared_memory.h>
#include "exchange/clients/shared_access.h"

namespace simvis {

class SharedObject;

/// A parameter as clients see it, in the unit of its element's table.
struct SharedParameter {
  std::string_view name;
  std::string_view unit{};
  double min, max;  ///< infinite: no limit
  bool open_min = false, open_max = false;
  double value = 0;
};

/// A value that a client has written since the last take().
struct WrittenValue {
  std::size_t parameter = 0;
  double value = 0;
};

/// All parameters of one element, written as a whole.
struct WrittenElement {
  std::uint32_t client = 0;
  std::size_t element = 0;
  std::vector<double> values;
};

struct ChangeRequest {
  std::uint32_t client = 0;
  std::uint64_t number = 0;
  std::string text;
};

/// The writes of clients since the last take(). Ids exist and counts fit; nothing else has been checked.
struct ClientInputs {
  std::vector<WrittenValue> values;      ///< by parameter
  std::vector<WrittenElement> elements;  ///< by client, then in the order of the client's groups
  std::vector<ChangeRequest> requests;   ///< by client, each client's in its order
};

/// Throws InputError if no simulation can be served under this name.
void check_served_name(const std::string& name);

/// The shared memory of one simulation. The layout and its rules: <simvis_client/shared_memory.h>.
///
/// Trust    what clients may write is copied and checked before it is used; the host keeps its own counts, values and
///          sequences, and never follows a number that it reads from the shared memory.
/// Waits    for nothing: what a client is in the middle of writing is read at the next take().
/// Errors   InputError: the name is not allowed, or another process has it. MachineError: the system refuses memory.
///          Nothing is thrown by what clients write.
/// Threads  one at a time.
class SharedHost {
 public:
  /// Makes the object `name`, which clients cannot find before publish().
  explicit SharedHost(const std::string& name, SharedAccess access = SharedAccess::user);
  SharedHost(const SharedHost&) = delete;
  SharedHost& operator=(const SharedHost&) = delete;
  /// Tells clients that the host ends.
  ~SharedHost();

  /// Clients find the object from now on. They expect the elements and sensors that the scene begins with to be there.
  void publish();

  /// Appends an element; returns its id. Its parameters get the following ids.
  std::size_t add_element(std::string_view name, std::string_view type, std::string_view insertion_point,
                          std::span<const SharedParameter> parameters);
  void remove_element(std::size_t element);
  /// Appends a sensor; returns its id.
  std::size_t add_sensor(std::string_view name, std::string_view type);
  /// Its measurements are gone, and their memory is free for other sensors.
  void remove_sensor(std::size_t sensor);
  /// Appends an entry to the log.
  void log(simvis_log_kind kind, std::string_view text, std::uint32_t client = 0, std::uint64_t request = 0);

  /// Reads what clients wrote. Entries of the log about nonsense in a client's area are written here.
  ClientInputs take();
  /// Publishes the present value of a parameter: after a written value was accepted or refused, and after any other
  /// change. A value that a client has written since the last take() stays, for the next one.
  void set_value(std::size_t parameter, double value);

  /// Writes the arrays of a measurement. `world_from_sensor` has 16 numbers, column by column.
  void publish(std::size_t sensor, std::uint64_t frame, std::int64_t time_ns, std::span<const double> world_from_sensor,
               std::span<const MeasuredArray> arrays);
  /// A frame is finished: its values are published and waiting clients are woken. `next_frame` is the index of the
  /// next.
  void finish_frame(std::uint64_t next_frame, std::int64_t time_ns);

  /// Whether a client of this name is connected and ready for frame `index`.
  bool is_ready(std::string_view client, std::uint64_t index) const;
  /// Whether a client of this name is connected.
  bool is_connected(std::string_view client) const;
  /// Waits until a client says that it is ready, or for `timeout_ns`.
  void wait_for_ready(std::uint32_t seen, std::int64_t timeout_ns) const;
  /// Changes whenever a client says that it is ready.
  std::uint32_t ready_counter() const;

 private:
  // The host's record of a client, copied from the client's area at the last take().
  struct Client {
    std::uint64_t connection = 0, request_tail = 0;
    std::uint64_t left =
        0;                 // the odd number that the client left behind, once the area has been read for the last time
    bool refused = false;  // its area makes no sense; ignored until another client connects
    std::array<std::uint64_t, SIMVIS_SHM_GROUPS> group_sequences{};
  };
  simvis_text add_text(std::string_view text);
  simvis_sensor& shared_sensor(std::size_t sensor);
  std::uint64_t place_outputs(std::span<const MeasuredArray> arrays);
  void make_slots(std::size_t sensor, std::uint64_t size);
  std::uint64_t take_slots(std::uint64_t bytes);
  void free_slots(std::size_t sensor);
  void add_free(std::uint64_t offset, std::uint64_t bytes);
  simvis_client_area& area(std::size_t client) const;
  bool holds_area(std::size_t client) const;
  bool refresh(std::uint32_t client);
  void take_values(ClientInputs& inputs);
  void take_groups(std::uint32_t client, ClientInputs& inputs);
  void take_requests(std::uint32_t client, ClientInputs& inputs);
  void refuse(std::uint32_t client, std::string_view why);

  std::unique_ptr<SharedObject> object_;
  std::vector<Client> clients_;
  std::vector<double> values_;                // by parameter
  std::vector<std::size_t> first_parameter_;  // by element, and one more
  std::vector<bool> element_removed_;
  struct Sensor {
    std::uint64_t measurement = 0, slots_offset = 0, slot_size = 0;
  };
  std::vector<Sensor> sensors_;
  std::vector<simvis_output> placed_;                  // of the measurement that is being written
  std::map<std::uint64_t, std::uint64_t> free_slots_;  // offset and bytes of what no sensor uses any more
  std::uint64_t publications_ = 0;                     // by all sensors: no two slots ever have the same sequence
  std::uint64_t frames_ = 0, frame_sequence_ = 0, next_frame_ = 0;
};

}  // namespace simvis
