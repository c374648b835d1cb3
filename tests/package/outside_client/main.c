/* There is no such simulation, and the library says so. */
#include <simvis_client/client.h>
#include <stdio.h>

int main(void) {
  if (simvis_connect("outside-client-none", "outside", 0) != NULL || !simvis_is_missing()) return 1;
  return puts(simvis_client_error()) < 0;
}
