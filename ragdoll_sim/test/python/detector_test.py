#!/usr/bin/python3
"""examples/falls_detector.py: on made-up records whose answers are known, and on a few falls."""

import importlib.util
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import numpy as np

SCRIPT = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..', 'examples', 'falls_detector.py')
spec = importlib.util.spec_from_file_location('falls_detector', SCRIPT)
detector = importlib.util.module_from_spec(spec)
spec.loader.exec_module(detector)

G = 9.81
TIME = np.arange(1, 401) / 100
LABEL = [('onset_time', float), ('impact_time', float)]


def still(count=1):
    imu = np.zeros((count, len(TIME), 6))
    imu[:, :, 2] = G
    return imu


def dropped(onset, impact, share=1.0, turn=0.0):
    """Stands, then falls with so much of g, turning [rad/s], then lies."""
    imu = still()[0]
    fall = (TIME > onset + 1e-9) & (TIME <= impact + 1e-9)
    imu[fall, 2] = (1 - share) * G
    imu[fall, 4] = turn
    return imu


class DetectorTest(unittest.TestCase):
    def test_features_of_rest_and_of_free_fall(self):
        features = detector.features_of(np.stack([still()[0], dropped(1, 1.5, turn=2)]))
        np.testing.assert_allclose(features[0], 0, atol=1e-12)
        # The mean of five samples falls by a fifth of g with each: 1.00 s is the last at rest.
        np.testing.assert_allclose(features[1, 99:105, 0], np.arange(6) / 5, atol=1e-9)
        np.testing.assert_allclose(features[1, 99:105, 1], 2 * np.arange(6) / 5, atol=1e-9)

    def test_a_still_body_gives_no_alarm_and_a_dropped_one_after_the_known_time(self):
        features = detector.features_of(np.stack([still()[0], dropped(1, 1.5), dropped(0.7, 1.2, 0.3)]))
        first = detector.first_alarms(features, TIME, 1.0, 0.5)
        self.assertEqual(first[0], np.inf)
        self.assertAlmostEqual(first[1], 1.03)  # three of five samples are weightless: 0.6 > 0.5
        self.assertEqual(first[2], np.inf)      # light by 0.3 only
        self.assertAlmostEqual(detector.first_alarms(features, TIME, 1.0, 0.25)[2], 0.75)

    def test_what_comes_later_than_the_warning_does_not_count(self):
        labels = np.array([(1, 1.5), (1, 1.05)], dtype=LABEL)
        features = detector.features_of(np.stack([dropped(1, 1.5), dropped(1, 1.05)]))
        peak = detector.peaks(features @ [1, 0], TIME, labels)
        np.testing.assert_allclose(peak, [1, 0], atol=1e-12)

    def test_training_finds_its_share_and_no_more(self):
        """Falls of lightness 0.20, 0.21 ... 0.99: the threshold leaves 5 % of them below."""
        share = np.arange(20, 100) / 100
        labels = np.array([(1, 1.5)] * len(share), dtype=LABEL)
        features = detector.features_of(np.stack([dropped(1, 1.5, s) for s in share]))
        weight, threshold = detector.train(features, TIME, labels)
        found = detector.first_alarms(features, TIME, weight, threshold) < 1.4
        self.assertEqual(found.sum(), 76)
        np.testing.assert_array_equal(found, share > 0.235)

    def test_few_falls_are_found_in_time_and_none_before_its_onset(self):
        folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, folder)
        run = subprocess.run([sys.executable, SCRIPT, folder, '120', '40'], stdout=subprocess.PIPE,
                             universal_newlines=True)
        self.assertEqual(run.returncode, 0, run.stdout)
        found, early = re.search(r'(\S+) % found 100 ms .*, (\S+) % alarms before', run.stdout).groups()
        self.assertGreater(float(found), 80)
        self.assertEqual(float(early), 0)
        median = float(re.search(r'median (\d+) ms', run.stdout).group(1))
        self.assertTrue(150 < median < 900, run.stdout)  # free fall from standing lasts 0.55 s
        weight, threshold = map(float, re.search(r'\+ (\S+) s/rad \* turning > (\S+)', run.stdout).groups())
        features, time, labels = detector.falls(folder, 121, 40)
        first = detector.first_alarms(features, time, weight, threshold)
        score = features @ [1, weight]
        for k, row in enumerate(labels):
            quiet = time <= row['onset_time'] + 1e-9
            self.assertLess(score[k, quiet].max(), 0.2 * threshold)  # held still
            if score[k].max() > threshold:
                self.assertTrue(row['onset_time'] < first[k] < 4, row['seed'])
            else:  # out of bed one rolls slowly, and not far
                self.assertEqual((first[k], row['start']), (np.inf, b'bed'), row['seed'])


if __name__ == '__main__':
    unittest.main()
