#define _GNU_SOURCE
#include "exchange/messages/dds/domain_sockets.h"

#include <dds/ddsi/ddsi_domaingv.h>
#include <dds/ddsi/ddsi_sertype.h>
#include <dds/ddsi/ddsi_tran.h>
#include <errno.h>
#include <string.h>
#include <sys/socket.h>

static const struct ddsi_domaingv* domain_of(const struct ddsi_sertype* type) {
  return ddsrt_atomic_ldvoidp(&type->gv);
}

const char* simvis_domain_interface(const struct ddsi_sertype* type, size_t index) {
  const struct ddsi_domaingv* const domain = domain_of(type);
  return index < (size_t)domain->n_interfaces ? domain->interfaces[index].name : NULL;
}

int simvis_is_domain_local(const struct ddsi_sertype* type) {
  const struct ddsi_domaingv* const domain = domain_of(type);
  for (int i = 0; i < domain->n_interfaces; ++i) {
    if (!domain->interfaces[i].loopback) return 0;
  }
  return 1;
}

static int bind_socket(ddsi_tran_conn_t connection, const char* interface) {
  if (connection == NULL) return 0;
  const socklen_t size = (socklen_t)strlen(interface);
  return setsockopt(ddsi_conn_handle(connection), SOL_SOCKET, SO_BINDTODEVICE, interface, size) == 0 ? 0 : errno;
}

int simvis_bind_domain(const struct ddsi_sertype* type) {
  const struct ddsi_domaingv* const domain = domain_of(type);
  const char* const interface = domain->interfaces[0].name;
  const ddsi_tran_conn_t receiving[] = {domain->disc_conn_mc, domain->data_conn_mc, domain->disc_conn_uc,
                                        domain->data_conn_uc};
  int error = 0;
  for (size_t i = 0; i < sizeof receiving / sizeof *receiving && error == 0; ++i) {
    error = bind_socket(receiving[i], interface);
  }
  for (int i = 0; i < domain->n_interfaces && error == 0; ++i) error = bind_socket(domain->xmit_conns[i], interface);
  return error;
}
