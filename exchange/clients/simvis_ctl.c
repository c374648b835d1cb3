/* simvis-ctl: reads and writes a running simulation from a shell. */
#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <simvis_client/client.h>

enum { DONE = 0, FAILED = 1, WRONG_INPUT = 2 };
#define CONNECT_MS 2000
#define REQUEST_MS 10000

static const char kUsage[] =
    "usage: simvis-ctl NAME COMMAND\n"
    "  list                        elements with their parameters (value, unit, limits), and sensors\n"
    "  get ELEMENT.PARAM...        their values, one a line\n"
    "  set ELEMENT.PARAM=VALUE...  sets them; those of one element together\n"
    "  watch ELEMENT.PARAM...      their values with the simulated time after each frame, until it is interrupted\n"
    "  send FILE.xml               requests the file's commands (- : the standard input) and waits for the outcome\n"
    "  log                         everything that was requested, refused and changed\n"
    "  frames                      the number of each finished frame and its simulated time, until it is interrupted\n"
    "NAME is that of simvis-run --serve. Exit status: 0 done; 1 it could not be done; 2 the command line is wrong.\n";

static const char kDamaged[] = "the memory of the simulation is damaged";

static int fail(int status, const char* what) {
  fprintf(stderr, "simvis-ctl: %s\n", what);
  return status;
}

static void print_text(const simvis_client* client, struct simvis_text text) {
  const char* const bytes = simvis_text_at(client, text);
  if (bytes != NULL) fwrite(bytes, 1, text.size, stdout);
}

static void print_limit(double value, int open, int is_min) {
  if (isinf(value)) {
    fputs(is_min ? "(-inf" : "inf)", stdout);
  } else if (is_min) {
    printf("%c%.17g", open ? '(' : '[', value);
  } else {
    printf("%.17g%c", value, open ? ')' : ']');
  }
}

static int list(const simvis_client* client) {
  for (uint64_t e = 0; e < simvis_element_count(client); ++e) {
    const struct simvis_element* const element = simvis_element_at(client, (int64_t)e);
    if (element->removed) continue;
    fputs("element ", stdout);
    print_text(client, element->name);
    fputs(", ", stdout);
    print_text(client, element->type);
    fputs(" at ", stdout);
    print_text(client, element->insertion_point);
    putchar('\n');
    for (uint32_t i = 0; i < element->parameter_count; ++i) {
      const int64_t id = (int64_t)(element->first_parameter + i);
      const struct simvis_parameter* const parameter = simvis_parameter_at(client, id);
      if (parameter == NULL) return fail(FAILED, kDamaged);
      fputs("  ", stdout);
      print_text(client, element->name);
      putchar('.');
      print_text(client, parameter->name);
      printf(" = %.17g ", simvis_get(client, id));
      print_text(client, parameter->unit);
      putchar(' ');
      print_limit(parameter->min, parameter->flags & SIMVIS_OPEN_MIN, 1);
      fputs(", ", stdout);
      print_limit(parameter->max, parameter->flags & SIMVIS_OPEN_MAX, 0);
      putchar('\n');
    }
  }
  for (uint64_t s = 0; s < simvis_sensor_count(client); ++s) {
    const struct simvis_sensor* const sensor = simvis_sensor_at(client, (int64_t)s);
    if (sensor->removed) continue;
    fputs("sensor ", stdout);
    print_text(client, sensor->name);
    fputs(", ", stdout);
    print_text(client, sensor->type);
    printf(", %llu measurements\n", (unsigned long long)sensor->measurement);
  }
  return DONE;
}

/* The id of "ELEMENT.PARAM"; -1 with a message. The last dot is the separator. */
static int64_t parameter_of(const simvis_client* client, const char* text, size_t size) {
  char name[1024];
  if (size >= sizeof name) return fail(-1, "a name is too long");
  memcpy(name, text, size);
  name[size] = '\0';
  char* const dot = strrchr(name, '.');
  if (dot == NULL) {
    fprintf(stderr, "simvis-ctl: \"%s\": expected ELEMENT.PARAM\n", name);
    return -1;
  }
  *dot = '\0';
  const int64_t id = simvis_find_parameter(client, name, dot + 1);
  if (id < 0) fail(-1, simvis_client_error());
  return id;
}

static int get(const simvis_client* client, char** names) {
  for (; *names != NULL; ++names) {
    const int64_t id = parameter_of(client, *names, strlen(*names));
    if (id < 0) return WRONG_INPUT;
    printf("%.17g\n", simvis_get(client, id));
  }
  return DONE;
}

/* Sets all assignments of the element of the first one, and marks them as done by an empty text. */
static int set_one_element(simvis_client* client, char** assignments) {
  double values[SIMVIS_SHM_GROUP_VALUES];
  int64_t element = -1;
  uint64_t first = 0;
  uint32_t count = 0;
  for (char** each = assignments; *each != NULL; ++each) {
    char* const equals = strchr(*each, '=');
    char* end = NULL;
    if (**each == '\0') continue;
    if (equals == NULL) return fail(WRONG_INPUT, "expected ELEMENT.PARAM=VALUE");
    const int64_t id = parameter_of(client, *each, (size_t)(equals - *each));
    if (id < 0) return WRONG_INPUT;
    const double value = strtod(equals + 1, &end);
    if (end == equals + 1 || *end != '\0') return fail(WRONG_INPUT, "expected a number after =");
    const struct simvis_parameter* const parameter = simvis_parameter_at(client, id);
    if (parameter == NULL) return fail(FAILED, kDamaged);
    const int64_t own = (int64_t)parameter->element;
    if (element < 0) {
      const struct simvis_element* const entry = simvis_element_at(client, own);
      if (entry == NULL) return fail(FAILED, kDamaged);
      element = own;
      first = entry->first_parameter;
      count = entry->parameter_count;
      if (count > SIMVIS_SHM_GROUP_VALUES) return fail(FAILED, "the element has too many parameters");
      for (uint32_t i = 0; i < count; ++i) values[i] = simvis_get(client, (int64_t)(first + i));
    }
    if (own != element) continue;
    const uint64_t place = (uint64_t)id - first;
    if (place >= count) return fail(FAILED, kDamaged);
    values[place] = value;
    **each = '\0';
  }
  if (element < 0) return DONE;
  if (simvis_set_element(client, element, values, count) != 0) {
    return fail(FAILED, simvis_client_error());
  }
  return -1; /* there may be more */
}

/* Prints the values of this client that the host has refused since a position of the log. */
static int print_refused(const simvis_client* client, uint64_t position) {
  const struct simvis_log_entry* entry;
  const char* why = NULL;
  int status = DONE;
  while ((entry = simvis_next_log(client, &position, &why)) != NULL) {
    if (entry->kind != SIMVIS_VALUE_REFUSED || entry->client != simvis_slot_of(client)) continue;
    fprintf(stderr, "simvis-ctl: %.*s\n", (int)entry->text_size, why);
    status = WRONG_INPUT;
  }
  return status;
}

static int set(simvis_client* client, char** assignments) {
  uint64_t position = 0;
  while (simvis_next_log(client, &position, NULL) != NULL) {
  }
  for (;;) {
    const int status = set_one_element(client, assignments);
    if (status >= 0 && status != DONE) return status;
    if (status == DONE) break;
  }
  /* The frame under way may have been begun before the values were written; the one after it was not. */
  return simvis_wait_frame(client, simvis_frame(client) + 1, REQUEST_MS) == 1
             ? print_refused(client, position)
             : fail(FAILED, "the host makes no frames");
}

static int watch(const simvis_client* client, char** names) {
  int64_t ids[64];
  size_t count = 0;
  for (; names[count] != NULL; ++count) {
    if (count == sizeof ids / sizeof *ids) return fail(WRONG_INPUT, "too many names");
    ids[count] = parameter_of(client, names[count], strlen(names[count]));
    if (ids[count] < 0) return WRONG_INPUT;
  }
  uint64_t frames = simvis_frame(client);
  while (simvis_wait_frame(client, frames, -1) == 1) {
    frames = simvis_frame(client);
    printf("%.9f", (double)simvis_time_ns(client) / 1e9);
    for (size_t i = 0; i < count; ++i) {
      double value = NAN;
      simvis_applied(client, (uint64_t)ids[i], &value, 1);
      printf(" %.17g", value);
    }
    putchar('\n');
    fflush(stdout);
  }
  return DONE;
}

static int frames(const simvis_client* client) {
  uint64_t seen = simvis_frame(client);
  while (simvis_wait_frame(client, seen, -1) == 1) {
    seen = simvis_frame(client);
    printf("%llu %.9f\n", (unsigned long long)seen, (double)simvis_time_ns(client) / 1e9);
    fflush(stdout);
  }
  return DONE;
}

static int print_log(const simvis_client* client) {
  static const char* const kKinds[] = {"?", "change", "done", "refused", "value refused", "client refused"};
  const struct simvis_log_entry* entry;
  const char* text = NULL;
  uint64_t position = 0;
  while ((entry = simvis_next_log(client, &position, &text)) != NULL) {
    printf("frame %llu: %s", (unsigned long long)entry->frame, kKinds[entry->kind <= 5 ? entry->kind : 0]);
    if (entry->request != 0) {
      printf(", request %llu of client %u", (unsigned long long)entry->request, entry->client);
    }
    if (entry->text_size > 0) printf(": %.*s", (int)entry->text_size, text);
    putchar('\n');
  }
  return DONE;
}

static char* read_file(const char* path) {
  FILE* const file = strcmp(path, "-") == 0 ? stdin : fopen(path, "rb");
  if (file == NULL) {
    fprintf(stderr, "simvis-ctl: %s: %s\n", path, strerror(errno));
    return NULL;
  }
  char* const text = malloc(SIMVIS_SHM_REQUEST_BYTES + 1);
  const size_t size = text == NULL ? 0 : fread(text, 1, SIMVIS_SHM_REQUEST_BYTES, file);
  if (text != NULL) text[size] = '\0';
  if (file != stdin) fclose(file);
  return text;
}

static int send_file(simvis_client* client, const char* path) {
  char* const text = read_file(path);
  uint64_t position = 0, frames_seen = simvis_frame(client);
  if (text == NULL) return WRONG_INPUT;
  while (simvis_next_log(client, &position, NULL) != NULL) {
  }
  const uint64_t number = simvis_send(client, text);
  free(text);
  if (number == 0) return fail(FAILED, simvis_client_error());
  for (;;) {
    const struct simvis_log_entry* entry;
    const char* outcome = NULL;
    while ((entry = simvis_next_log(client, &position, &outcome)) != NULL) {
      if (entry->request != number || entry->client != simvis_slot_of(client)) continue;
      if (entry->kind == SIMVIS_REQUEST_DONE) return DONE;
      if (entry->kind == SIMVIS_REQUEST_REFUSED) {
        fprintf(stderr, "%.*s\n", (int)entry->text_size, outcome);
        return FAILED;
      }
    }
    if (simvis_wait_frame(client, frames_seen, REQUEST_MS) != 1) return fail(FAILED, "the host makes no frames");
    frames_seen = simvis_frame(client);
  }
}

int main(int count, char** arguments) {
  if (count >= 2 && (strcmp(arguments[1], "--help") == 0 || strcmp(arguments[1], "-h") == 0)) {
    fputs(kUsage, stdout);
    return DONE;
  }
  if (count < 3) {
    fputs(kUsage, stderr);
    return WRONG_INPUT;
  }
  const char* const command = arguments[2];
  char** const names = arguments + 3;
  simvis_client* const client = simvis_connect(arguments[1], "simvis-ctl", CONNECT_MS);
  if (client == NULL) return fail(FAILED, simvis_client_error());
  int status = WRONG_INPUT;
  if (strcmp(command, "list") == 0 && count == 3) {
    status = list(client);
  } else if (strcmp(command, "get") == 0 && count > 3) {
    status = get(client, names);
  } else if (strcmp(command, "set") == 0 && count > 3) {
    status = set(client, names);
  } else if (strcmp(command, "watch") == 0 && count > 3) {
    status = watch(client, names);
  } else if (strcmp(command, "send") == 0 && count == 4) {
    status = send_file(client, names[0]);
  } else if (strcmp(command, "log") == 0 && count == 3) {
    status = print_log(client);
  } else if (strcmp(command, "frames") == 0 && count == 3) {
    status = frames(client);
  } else {
    fputs(kUsage, stderr);
  }
  simvis_disconnect(client);
  return status;
}
