"""small_gicp: pairs of clouds indoors, half a second of a robot's way apart, laid together without a first guess.

packages: small-gicp==1.0.1 numpy==2.4.6
"""
import small_gicp

import trial


def align_all(clouds):
    return [small_gicp.align(target, source, downsampling_resolution=0.1).T_target_source
            for target, source in zip(clouds, clouds[1:])]


def measure(folder):
    return trial.pair_rows(folder, align_all)


trial.main(measure)
