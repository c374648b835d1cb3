// Hands the shared memory of a host to its clients: a Unix socket with the host's name, and a thread that answers on
// it.
#pragma once

#include <string>
#include <thread>

#include "exchange/clients/shared_access.h"

namespace simvis {

/// A client that connects receives an open file of its own of the memory. A program that `access` does not admit
/// receives nothing. A process that was forked from the host's keeps no copy of the socket, so the name ends with the
/// host.
///
/// Errors   InputError: another process has the name. MachineError: the system refuses a socket or a thread.
class ClientListener {
 public:
  /// Clients find the host from now on. `object` stays open as long as the listener lives.
  ClientListener(const std::string& name, int object, SharedAccess access);
  ClientListener(const ClientListener&) = delete;
  ClientListener& operator=(const ClientListener&) = delete;
  /// The name is free afterwards.
  ~ClientListener();

 private:
  void answer_clients() const;
  bool admits(int connection) const;

  int socket_, object_;
  SharedAccess access_;
  std::thread thread_;
};

}  // namespace simvis
