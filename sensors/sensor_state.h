// The states of sensors, and measurements as a part of them.
#pragma once

#include <simvis/measurement.h>
#include <simvis/scan.h>
#include <simvis/sensor.h>
#include <simvis/state_archive.h>

namespace simvis {

/// The state of a sensor, if it has one. A sensor whose measurements depend on earlier frames has to be Stateful,
/// except for one that only reads the motion of its world and one that is off. Throws InputError for another one.
void archive_state(StateArchive& state, Sensor& sensor);

/// Writes or reads the stamp, the pose and the numbers of a measurement. The measurement that is read into keeps its
/// calibrations and, by name, the descriptions of its outputs.
void archive_measurement(StateArchive& state, Measurement& measurement);

/// Requires numbers of a scan that was read: what can be drawn. Ranges need not be finite.
void require_scan(const StateArchive& state, const Scan& scan);

/// The reading with the columns of `reading` and the numbers of `measurement`, after archive_measurement(). Throws
/// InputError for other columns.
Reading reading_of(const StateArchive& state, Reading reading, const Measurement& measurement);

}  // namespace simvis
