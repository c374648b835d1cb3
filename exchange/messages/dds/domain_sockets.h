/* The network interfaces and sockets of a domain of Cyclone DDS, whose header for them is C alone. */
#ifndef SIMVIS_DOMAIN_SOCKETS_H
#define SIMVIS_DOMAIN_SOCKETS_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

struct ddsi_sertype;

/* The name of an interface that the domain uses, in which the type has a topic; NULL beyond the last one. */
const char* simvis_domain_interface(const struct ddsi_sertype* type, size_t index);
/* Whether all interfaces that the domain uses are loopback. */
int simvis_is_domain_local(const struct ddsi_sertype* type);
/* Binds all sockets of the domain to the first interface that it uses: they neither receive from others nor send to
 * them. Returns 0, or the error as errno has it. */
int simvis_bind_domain(const struct ddsi_sertype* type);

#ifdef __cplusplus
}
#endif
#endif
