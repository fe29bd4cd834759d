#!/usr/bin/env python3
"""Film the arm's ArUco markers and write what `proprio align` reads (docs/tutorials/your-own-arm.md). Needs opencv-python 4.7 or newer.

    aruco_to_csv.py VIDEO_OR_CAMERA_NUMBER CAMERA.csv

Stop a live camera with Ctrl-C.
"""

import csv
import math
import sys
import time

import cv2
import numpy

SEGMENTS = 6
BASE = 0  # marker K sits at the end of segment K, its upper edge towards the tip
# Four markers that lie still around the arm, as high as those on it: their centres on the table in mm, seen from above,
# with x to the right and y up as on squared paper.
FIXED = {10: (0, 0), 11: (800, 0), 12: (800, 800), 13: (0, 800)}


def pose(corners, to_table):
    """x, y in mm and heading in degrees, clockwise from y, of a marker in the picture."""
    top_left, top_right, bottom_right, bottom_left = cv2.perspectiveTransform(corners.reshape(1, 4, 2), to_table)[0]
    x, y = (top_left + top_right + bottom_right + bottom_left) / 4
    dx, dy = (top_left + top_right - bottom_right - bottom_left) / 2
    return [f"{x:.3f}", f"{y:.3f}", f"{math.degrees(math.atan2(dx, dy)):.3f}"]


def main(source, target):
    live = source.isdigit()
    video = cv2.VideoCapture(int(source) if live else source)
    detector = cv2.aruco.ArucoDetector(cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50))
    names = ["base"] + [f"truth{k}" for k in range(1, SEGMENTS + 1)]
    markers = [BASE] + list(range(1, SEGMENTS + 1))
    to_table = None
    with open(target, "w", newline="") as file:
        table = csv.writer(file)
        table.writerow(["time_s"] + [f"{name}_{part}" for name in names for part in ("x_mm", "y_mm", "heading_deg")])
        while True:
            # When the picture was taken, not which one it is: frames get lost.
            taken, picture = video.read()
            time_s = time.time() if live else video.get(cv2.CAP_PROP_POS_MSEC) / 1000
            if not taken:
                break
            found, ids, _ = detector.detectMarkers(picture)
            seen = {} if ids is None else dict(zip(ids.flatten().tolist(), found))
            if all(marker in seen for marker in FIXED):
                centres = numpy.float32([seen[marker].reshape(4, 2).mean(axis=0) for marker in FIXED])
                to_table = cv2.getPerspectiveTransform(centres, numpy.float32(list(FIXED.values())))
            if to_table is None:
                continue
            poses = [pose(seen[marker], to_table) if marker in seen else ["", "", ""] for marker in markers]
            table.writerow([f"{time_s:.6f}"] + [cell for cells in poses for cell in cells])


if __name__ == "__main__":
    try:
        main(*sys.argv[1:])
    except KeyboardInterrupt:
        pass
