/* Drives a robot by what its front scanner sees: driver NAME. Ends with the simulation.
 *
 * The robot is the element R_POSE, the scanner is FRONT_SCANNER. driver.cpp and driver.py beside this file do the same.
 *
 *   cc -o driver driver.c -lsimvis-client -lm
 */
#include <math.h>
#include <stdio.h>

#include <simvis_client/client.h>

static const double kPi = 3.141592653589793;
static const double kFree_m = 3;   /* farther away, everything is as good */
static const double kStop_m = 0.6; /* nearer, the robot only turns */
static const int kWindow = 20;     /* beams on each side that must be free, too */
static const double kSpeed_m_s = 0.6, kTurn_deg_s = 90;
static const double kStraight_m = 1; /* a way straight ahead may be so much shorter than one at 90 degrees */

/* The way to go: its azimuth, and how far it is free. */
static double free_way(const float* ranges, const double* azimuths, int beams, double* distance) {
  double best = -INFINITY, way = 0;
  for (int i = 0; i < beams; ++i) {
    double nearest = kFree_m;
    for (int j = i - kWindow; j <= i + kWindow; ++j) {
      if (j >= 0 && j < beams && ranges[j] < nearest) nearest = ranges[j];
    }
    const double value = nearest - kStraight_m * fabs(azimuths[i]) / (kPi / 2);
    if (value <= best) continue;
    best = value;
    way = azimuths[i];
    *distance = nearest;
  }
  return way;
}

/* Reads the latest scan in place. Returns 0 if the host has begun to write over it. */
static int look(simvis_client* sim, double* way, double* distance) {
  struct simvis_view view;
  const struct simvis_output* shape;
  if (simvis_latest(sim, simvis_find_sensor(sim, "FRONT_SCANNER"), &view) != 0) return 0;
  const float* const ranges = simvis_output_data(&view, "range_m", &shape);
  const double* const azimuths = simvis_output_data(&view, "azimuth_rad", NULL);
  if (ranges == NULL || azimuths == NULL) return 0;
  *way = free_way(ranges, azimuths, (int)shape->columns, distance);
  return simvis_view_is_whole(&view);
}

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  simvis_client* const sim = simvis_connect(argv[1], "driver", 60000);
  const int64_t robot = sim == NULL ? -1 : simvis_find_element(sim, "R_POSE");
  if (robot < 0) {
    fprintf(stderr, "%s\n", simvis_client_error());
    return 1;
  }
  double pose[6]; /* x y z roll pitch yaw */
  const int64_t first = (int64_t)simvis_element_at(sim, robot)->first_parameter;
  for (int i = 0; i < 6; ++i) pose[i] = simvis_get(sim, first + i);
  uint64_t frame = simvis_frame(sim);
  double time_s = (double)simvis_time_ns(sim) / 1e9;
  simvis_ready(sim); /* in lock-step, each frame waits for this */
  while (simvis_wait_frame(sim, frame, -1) == 1) {
    frame = simvis_frame(sim);
    const double dt_s = (double)simvis_time_ns(sim) / 1e9 - time_s;
    time_s += dt_s;
    double way = 0, distance = 0;
    if (look(sim, &way, &distance)) {
      pose[5] += fmax(-kTurn_deg_s * dt_s, fmin(kTurn_deg_s * dt_s, way * 180 / kPi));
      const int ahead = fabs(way) < kPi / 6 && distance > kStop_m;
      const double step_m = ahead ? kSpeed_m_s * dt_s : 0;
      pose[0] += step_m * cos(pose[5] * kPi / 180);
      pose[1] += step_m * sin(pose[5] * kPi / 180);
      simvis_set_element(sim, robot, pose, 6); /* all of them at once */
    }
    simvis_ready(sim);
  }
  simvis_disconnect(sim);
  return 0;
}
