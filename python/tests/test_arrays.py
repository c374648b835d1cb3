"""Results as arrays: shapes, whose memory they are, and that they stay as they are."""
import gc
import copy
import pickle
import unittest
from typing import Any

import numpy as np
import simvis
from small_scene import load


class Arrays(unittest.TestCase):
    def setUp(self) -> None:
        self.sim = load()
        self.sim.step()

    def test_shapes_and_types(self) -> None:
        scanner, camera, eyes = self.sim["SCAN"], self.sim["CAM"], self.sim["EYES"]
        for array, shape, dtype in [
            (scanner.range_m, (3, 31), np.float32), (scanner.error_bound_m, (3, 31), np.float32),
            (scanner.intensity, (3, 31), np.float64), (scanner.points(), (93, 3), np.float64),
            (scanner.scan.azimuth_rad, (31,), np.float64), (scanner.scan.elevation_rad, (3,), np.float64),
            (scanner.pose, (4, 4), np.float64), (camera.color, (16, 32, 3), np.float32),
            (camera.rgb, (16, 32, 3), np.uint8), (camera.depth, (16, 32), np.float32),
            (eyes.disparity, (8, 16), np.float32), (eyes.image("right").array, (8, 16, 3), np.float32),
            (eyes.image("right_depth").array, (8, 16), np.float32)]:
            self.assertEqual((array.shape, array.dtype), (shape, dtype))
        self.assertEqual(eyes.images, ["left", "left_depth", "right", "right_depth", "disparity"])
        self.assertEqual(camera.images, ["color", "depth"])
        self.assertGreater(self.sim["PSD"].value("voltage_v"), 0)

    def test_values_mean_what_they_say(self) -> None:
        ahead = self.sim["SCAN"].scan
        middle = int(np.argmin(np.abs(ahead.azimuth_rad)))
        self.assertAlmostEqual(float(ahead.range_m[1, middle] * np.cos(ahead.elevation_rad[1])), 2.9, 4)
        depth = self.sim["CAM"].depth
        self.assertAlmostEqual(float(depth[8, 16]), 2.9, 4)
        local, world = ahead.points(), ahead.points("world")
        turned = local @ ahead.pose[:3, :3].T + ahead.pose[:3, 3]
        np.testing.assert_allclose(world, turned, atol=1e-12)

    def test_points_of_a_camera_are_what_its_pixels_see(self) -> None:
        camera = self.sim["CAM"]
        depth, points = camera.depth.astype(np.float64), camera.points()
        self.assertEqual(points.shape, (16 * 32, 3))
        # x is the depth; y and z grow with it and with the distance of the pixel's centre from that of the image.
        seen = np.isfinite(depth).ravel()
        np.testing.assert_array_equal(np.isnan(points[:, 0]), ~seen)
        np.testing.assert_allclose(points[seen, 0], depth.ravel()[seen], rtol=1e-15)
        across = (15.5 - np.tile(np.arange(32), 16)) * depth.ravel()
        ratio = points[seen, 1] / across[seen]
        np.testing.assert_allclose(ratio, ratio[0], rtol=1e-12)
        out = np.empty((16 * 32, 3))
        self.assertIs(camera.points("world", out), out)
        pose = camera.measurement.pose
        np.testing.assert_allclose(out[seen], points[seen] @ pose[:3, :3].T + pose[:3, 3], atol=1e-12)
        self.assertEqual(self.sim["EYES"].points().shape, (8 * 16, 3))

    def test_what_has_no_points_says_why(self) -> None:
        sim = simvis.Simulation.from_string("<sensor type='camera' name='FLAT' insert_at='ROOT'/>"
                                            "<sensor type='imu' name='IMU' insert_at='ROOT'/>")
        sim.step()
        with self.assertRaisesRegex(simvis.InputError, '"FLAT" has no points, since its outputs have no depth'):
            sim["FLAT"].points()
        with self.assertRaisesRegex(simvis.InputError, '"IMU", a imu, has no scan'):
            sim["IMU"].points()

    def test_views_are_read_only_and_cost_no_copy(self) -> None:
        for get in (lambda: self.sim["SCAN"].range_m, lambda: self.sim["EYES"].disparity, lambda: self.sim["CAM"].depth):
            view = get()
            self.assertFalse(view.flags.writeable)
            self.assertFalse(view.flags.owndata)
            self.assertEqual(view.ctypes.data, get().ctypes.data)
            with self.assertRaises(ValueError):
                view[0] = 1

    def test_colour_is_contiguous_and_read_only(self) -> None:
        camera = self.sim["CAM"]
        for color in (camera.color, camera.measurement["color"], camera.image("color").array, self.sim["EYES"].image("right").array):
            self.assertTrue(color.flags.c_contiguous)
            self.assertFalse(color.flags.writeable)
            self.assertEqual(color.shape[2], 3)
        self.assertTrue(np.from_dlpack(camera.image("color")).flags.c_contiguous)
        # A pixel of (r, g, b) linear radiance has these sRGB codes, by the formula of IEC 61966-2-1, rounded.
        linear = np.clip(camera.color.astype(np.float64), 0, 1)
        coded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
        half_code = 0.5 + 1e-3  # the rounding of float32 near a half
        self.assertLessEqual(np.abs(255 * coded - camera.rgb).max(), half_code)

    def test_a_view_keeps_its_frame(self) -> None:
        views, copies = [], []
        for frame in range(20):
            self.sim["P"].x = 0.05 * frame
            self.sim.step()
            views.append((self.sim["SCAN"].range_m, self.sim["CAM"].color, self.sim["SCAN"].intensity))
            copies.append([view.copy() for view in views[-1]])
        self.assertFalse(np.array_equal(copies[0][0], copies[1][0]))
        self.sim.execute('<remove name="SCAN"/>')
        self.sim.close()
        gc.collect()
        for view, copy in zip(views, copies):
            for kept, seen in zip(view, copy):
                np.testing.assert_array_equal(kept, seen)

    def test_a_view_keeps_its_frame_when_a_request_removes_nothing(self) -> None:
        view = self.sim["SCAN"].range_m
        copy = view.copy()
        self.sim.execute('<part shape="box" size="1 1 1" name="NEW" insert_at="ROOT" pose_offset="1.5 0 0.5 0 0 0"/>')
        self.sim.step()
        np.testing.assert_array_equal(view, copy)
        self.assertFalse(np.array_equal(self.sim["SCAN"].range_m, copy))

    def test_memory_is_used_again(self) -> None:
        addresses = set()
        for frame in range(50):
            self.sim["P"].x = 0.001 * frame
            self.sim.step()
            last = self.sim["CAM"].depth
            addresses.add(last.ctypes.data)
        self.assertLessEqual(len(addresses), 4)

    def test_out_fills_the_buffer_of_the_caller(self) -> None:
        scan, image = self.sim["SCAN"].scan, self.sim["CAM"].image()
        ranges, rgb, color = np.empty((3, 31), np.float32), np.empty((16, 32, 3), np.uint8), np.empty((16, 32, 3), np.float32)
        points = np.empty((93, 3))
        self.assertIs(scan.read(ranges), ranges)
        self.assertIs(scan.points(out=points), points)
        self.assertIs(image.rgb(rgb), rgb)
        self.assertIs(image.read(color), color)
        np.testing.assert_array_equal(ranges, scan.range_m)
        np.testing.assert_array_equal(points, scan.points())
        np.testing.assert_array_equal(rgb, image.rgb())
        np.testing.assert_array_equal(color, image.array)

    def test_arrays_and_dlpack(self) -> None:
        scan = self.sim["SCAN"].scan
        np.testing.assert_array_equal(np.asarray(scan), scan.range_m)
        self.assertEqual(np.asarray(scan).ctypes.data, scan.range_m.ctypes.data)
        exchanged = np.from_dlpack(self.sim["CAM"].image("depth"))
        self.assertEqual(exchanged.ctypes.data, self.sim["CAM"].depth.ctypes.data)
        self.assertFalse(exchanged.flags.writeable)
        np.testing.assert_array_equal(np.asarray(self.sim["CAM"].image(), dtype=np.float64), self.sim["CAM"].color)

    def test_consumers_that_know_no_read_only_memory_get_a_copy(self) -> None:
        class Old:
            """DLPack before 1.0: it names no version."""

            def __init__(self, measured: Any) -> None:
                self.measured = measured

            def __dlpack__(self, **how: Any) -> Any:
                return self.measured.__dlpack__()

            def __dlpack_device__(self) -> Any:
                return self.measured.__dlpack_device__()

        for measured in (self.sim["SCAN"].scan, self.sim["CAM"].image()):
            copy, view = np.from_dlpack(Old(measured)), np.asarray(measured)
            np.testing.assert_array_equal(copy, view)
            self.assertFalse(np.shares_memory(copy, view))
            with self.assertRaises(BufferError):
                measured.__dlpack__(copy=False)

    def test_readings(self) -> None:
        sim = load('<s><part name="R" insert_at="ROOT"/><element type="pose" name="P" insert_at="R" x="2"/>'
                   '<sensor type="imu" name="IMU" insert_at="R"/></s>')
        self.assertEqual(len(sim["IMU"].reading), 0)
        sim.step()
        reading, units = sim["IMU"].reading, sim["IMU"].units
        self.assertEqual((reading.shape, reading.dtype.names), ((1,), tuple(units)))
        self.assertEqual(units["specific_force_z_m_s2"], "m/s2")
        self.assertAlmostEqual(reading["specific_force_z_m_s2"][0], 9.80665, 5)
        self.assertEqual(reading["specific_force_z_m_s2"][0], sim["IMU"].value("specific_force_z_m_s2"))
        sim.close()
        self.assertEqual(len(reading), 1)

    def test_labels(self) -> None:
        sim = load('<s><part shape="box" size="1 9 9" name="WALL" insert_at="ROOT" pose_offset="3 0 0 0 0 0"/>'
                   '<part shape="sphere" radius="0.5" name="BALL" insert_at="ROOT" pose_offset="0 2 0 0 0 0"/>'
                   '<sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="3" min_angle="-90" max_angle="90"'
                   ' truth="hit"/></s>')
        sim.step()
        labels = sim["SCAN"].labels
        self.assertEqual((labels.shape, labels.dtype), ((1, 3), np.int32))
        self.assertEqual(labels[0, 0], -1)
        self.assertEqual([sim.items[label]["part"] for label in labels[0, 1:]], ["WALL", "BALL"])

    def test_step_async_shows_the_frame_before(self) -> None:
        before = self.sim["SCAN"].range_m
        self.sim["P"].x = 1
        self.sim.step_async()
        np.testing.assert_array_equal(self.sim["SCAN"].range_m, before)
        self.sim.finish()
        self.assertFalse(np.array_equal(self.sim["SCAN"].range_m, before))


def same(one: Any, other: Any) -> bool:
    return bool(np.array_equal(np.asarray(one), np.asarray(other), equal_nan=True)) and np.asarray(one).dtype == np.asarray(other).dtype


def copies(of: Any) -> list[Any]:
    return [pickle.loads(pickle.dumps(of)), copy.deepcopy(of), copy.copy(of)]


class Pickles(unittest.TestCase):
    """Measurements that went to another process and back are those that went."""

    def test_measurements(self) -> None:
        sim = load()
        sim.step()
        for name in sim.sensors:
            before = sim.sensors[name].measurement
            for after in copies(before):
                self.assertEqual(after.keys(), before.keys())
                self.assertEqual((after.units, after.sensor, after.time_ns), (before.units, before.sensor, before.time_ns))
                self.assertTrue(same(after.pose, before.pose))
                for output in before.keys():
                    self.assertTrue(same(after[output], before[output]), f"{name}.{output}")

    def test_scans_and_images(self) -> None:
        sim = load()
        sim.step()
        before = sim["SCAN"].scan
        for after in copies(before):
            for output in ("range_m", "error_bound_m", "azimuth_rad", "elevation_rad", "intensity", "pose"):
                self.assertTrue(same(getattr(after, output), getattr(before, output)), output)
            self.assertTrue(same(after.points("world"), before.points("world")))
            self.assertEqual((after.channels, after.sensor, after.time_s), (before.channels, before.sensor, before.time_s))
        for name in ("color", "depth"):
            for image in copies(sim["CAM"].image(name)):
                self.assertTrue(same(image.array, sim["CAM"].image(name).array))
                self.assertEqual((image.name, image.unit, image.width), (name, sim["CAM"].image(name).unit, 32))

    def test_a_copy_outlives_the_simulation(self) -> None:
        sim = load()
        sim.step()
        ranges = sim["SCAN"].range_m.copy()
        kept = pickle.dumps(sim["SCAN"].measurement)
        sim.close()
        self.assertTrue(same(pickle.loads(kept)["range_m"], ranges))

    def test_columns_of_a_table_take_their_own_numbers_alone(self) -> None:
        sim = load("""<simvis>
          <part shape="box" size="0.25 8 8" name="WALL" insert_at="ROOT" pose_offset="3 0 0 0 0 0"/>
          <sensor type="radar" name="RADAR" insert_at="ROOT" angle_step="0.5"/></simvis>""")
        sim.step()
        measurement = sim["RADAR"].measurement
        rows, columns = len(measurement["range_m"]), len(measurement.keys())
        self.assertGreater(rows, 20)
        rest = 200 * columns + 2000  # names, units and types of the columns; names and pose of the measurement
        self.assertLess(len(pickle.dumps(measurement)), 8 * rows * columns + rest)

    def test_shapes_that_do_not_fit_the_numbers_are_refused(self) -> None:
        sim = load()
        sim.step()
        big, half = 2**32 - 1, 2**31
        # name, kind, type of the numbers, rows, columns, channels, unit, type in memory, numbers, content, ...
        shapes = [(half, half, 4), (big, big, big), (2**22, 2**22, 2**20), (half, half, 0), (big, 0, 1), (0, big, 1)]
        for whole, at in ((sim["CAM"].image("color"), 2), (sim["CAM"].image("depth"), 2), (sim["SCAN"].measurement, 4),
                          (sim["SCAN"].scan, 4), (sim["PSD"].measurement, 4)):
            state = whole.__getstate__()
            array = state[at] if at == 2 else state[at][0]
            damages = [(*array[:3], *shape, *array[6:8], numbers, *array[9:])
                       for shape in shapes for numbers in (b"", array[8][:32])]
            damages += [(array[0], kind, *array[2:]) for kind in (-1, 4, 256)]
            damages += [(*array[:2], kind, *array[3:]) for kind in (-1, 6, 256)]
            damages += [(*array[:9], content, *array[10:]) for content in (-1, 5, 257)]
            damages += [array[:length] for length in range(len(array))]
            damages += [(*array[:1], kind, *array[2:3], 2, 3, 1, *array[6:8], bytes(8 * 6), *array[9:]) for kind in (2, 3)]
            for damage in damages:
                given = damage if at == 2 else [damage, *state[at][1:]]
                with self.subTest(damage=str(damage)[:90]), self.assertRaises(simvis.InputError):
                    type(whole).__new__(type(whole)).__setstate__((*state[:at], given, *state[at + 1:]))

    def test_what_is_no_measurement_is_refused(self) -> None:
        sim = load()
        sim.step()
        for whole in (sim["SCAN"].scan, sim["SCAN"].measurement, sim["CAM"].image()):
            state = whole.__getstate__()
            for wrong in ((), state[:-1], ("0.0.0", *state[1:]), (7, *state[1:]), tuple(None for _ in state), (*state[:-1], 3.5)):
                empty = type(whole).__new__(type(whole))
                with self.subTest(wrong=str(wrong)[:60]), self.assertRaises(simvis.InputError):
                    empty.__setstate__(wrong)
        state = sim["SCAN"].scan.__getstate__()
        arrays = state[4]
        for place, array in enumerate(arrays[:4]):  # ranges, bounds and angles that no longer fit to the others, or are gone
            rows = array[4] + 1
            turned = (*array[:3], rows, 1, *array[5:8], bytes(len(array[8]) // array[4] * rows), *array[9:])
            for given in ([turned], []):
                with self.subTest(array=array[0], given=len(given)), self.assertRaises(simvis.InputError):
                    simvis.Scan.__new__(simvis.Scan).__setstate__(
                        (*state[:4], [*arrays[:place], *given, *arrays[place + 1:]], *state[5:]))


if __name__ == "__main__":
    unittest.main()
