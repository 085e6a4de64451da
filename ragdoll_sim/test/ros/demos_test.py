#!/usr/bin/python3
"""The launch files and the grippers push.py and rescue.py, started as a user does, without rviz."""

import csv
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest

import rosbag
import roslib.packages
import rosnode
import rospy
import rostest
import yaml
from bags import contents
from client import LIMIT, Client, Inbox, position, start_node, wait_for
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import Marker, MarkerArray

LONG = 100  # [s] for what computes as fast as it can


def points(ragdoll):
    return [(p.x, p.y, p.z) for p in ragdoll.positions]


def middle(ragdoll):
    return [sum(c) / len(ragdoll.positions) for c in zip(*points(ragdoll))]


def with_another(scene):
    """The scene's text, where the body is the second one, ben."""
    path = os.path.join(roslib.packages.get_pkg_dir('ragdoll_sim'), 'scenes', scene + '.yaml')
    with open(path) as file:
        known = yaml.safe_load(file)
    ben = dict(known['ragdolls'][0], name='ben')
    known['ragdolls'] = [dict(ben, name='anna', position=[0, 4, 0.13]), ben]
    return yaml.safe_dump(known)


class DemosTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)

    def start(self, *arguments):
        """roslaunch in a terminal that stands in self.folder, of a launch file by name or by path."""
        package = [] if os.path.isabs(arguments[0]) else ['ragdoll']
        log = open(os.path.join(self.folder, 'log'), 'w')
        self.addCleanup(log.close)
        launch = subprocess.Popen(['roslaunch'] + package + list(arguments), cwd=self.folder,
                                  env=dict(os.environ, PWD=self.folder), stdin=subprocess.DEVNULL,
                                  stdout=log, stderr=subprocess.STDOUT)
        self.addCleanup(self.end, launch)
        return launch

    def end(self, launch):
        """As by Ctrl-C."""
        if launch.poll() is None:
            launch.send_signal(signal.SIGINT)
        launch.wait(LONG)

    def log(self):
        with open(os.path.join(self.folder, 'log')) as log:
            return log.read()

    def record_falls(self, out, falls=2, seed=4, rate=60):
        launch = self.start('fall_dataset.launch', 'falls:=%d' % falls, 'seed:=%d' % seed,
                            'seconds:=3', 'rate:=%d' % rate, 'out:=' + out)
        launch.wait(LONG)
        return os.path.join(self.folder, out)

    def test_every_launch_file_starts_rviz(self):
        """With its default arguments, rviz among them: what roslaunch would start."""
        folder = os.path.join(roslib.packages.get_pkg_dir('ragdoll'), 'launch')
        for name in sorted(n for n in os.listdir(folder) if n.endswith('.launch')):
            with self.subTest(name):
                given = ['bag:=fall.bag'] if name == 'playback.launch' else []
                run = subprocess.run(['roslaunch', '--nodes', os.path.join(folder, name)] + given,
                                     stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=LONG,
                                     universal_newlines=True)
                self.assertEqual(run.returncode, 0, run.stdout)
                if name != 'fall_dataset.launch':
                    self.assertIn('/rviz', run.stdout)

    def test_a_crowd_falls_and_comes_to_rest(self):
        launch = self.start('crowd.launch', 'rviz:=false', 'realtime_factor:=8')
        client = Client()
        names = ['crowd_%d' % i for i in range(20)]
        self.assertEqual([r.name for r in client.model.ragdolls], names)
        frames = Inbox('/tf', TFMessage)
        wait_for(lambda: {t.child_frame_id for m in frames.all()[-1:] for t in m.transforms} >=
                 {name + '/head' for name in names}, 'the frames of all')
        client.restart()
        start = [middle(r) for r in client.states.all()[-1].ragdolls]
        self.assertTrue(all(at[2] > 1.5 for at in start))
        client.call_pause(False)
        wait_for(lambda: sum(r.asleep for r in client.states.all()[-1].ragdolls) == 20,
                 'all at rest')
        for ragdoll, at in zip(client.states.all()[-1].ragdolls, start):
            lies = middle(ragdoll)
            self.assertLess(lies[2], 0.3)
            self.assertLess(abs(lies[0] - at[0]) + abs(lies[1] - at[1]), 1.5)
            self.assertGreater(min(p[2] for p in points(ragdoll)), 0)
            self.assertEqual({v for w in ragdoll.velocities for v in (w.x, w.y, w.z)}, {0})
        self.end(launch)

    def test_a_crowd_of_any_size_by_any_preset(self):
        launch = self.start('crowd.launch', 'rviz:=false', 'bodies:=30', 'preset:=fast')
        client = Client()
        self.assertEqual(len(client.model.ragdolls), 30)
        self.assertIn('method: fast', client.model.scene_yaml)
        self.end(launch)

    def test_a_data_set_is_there_and_the_same_for_the_same_seed(self):
        first, second = (self.record_falls(out) for out in ('first', 'second'))
        for out in (first, second):
            self.assertEqual(sorted(os.listdir(out)),
                             ['fall_000004.bag', 'fall_000005.bag', 'labels.csv'], self.log())
        with open(os.path.join(first, 'labels.csv'), newline='') as file:
            rows = list(csv.DictReader(file))
        with open(os.path.join(first, 'labels.csv')) as a, \
                open(os.path.join(second, 'labels.csv')) as b:
            self.assertEqual(a.read(), b.read())
        lab = roslib.packages.find_node('ragdoll_sim', 'ragdoll_lab')[0]
        for row, seed in zip(rows, (4, 5)):
            self.assertEqual((row['bag'], row['seed']), ('fall_%06d.bag' % seed, str(seed)))
            self.assertTrue(0 < float(row['impact_time']) < 3)
            self.assertIn(row['end_pose'], ('upright', 'supine', 'prone', 'on_left_side',
                                            'on_right_side'))
            found = contents(os.path.join(first, row['bag']))
            self.assertEqual(found, contents(os.path.join(second, row['bag'])))
            topics = [topic for topic, _, _ in found]
            self.assertEqual(topics.count('/ragdoll/state'), 3 * 60 + 1)
            runs = 2 if row['kind'] in ('faint', 'trip') else 1  # held at first, and from where pins let go
            self.assertEqual((topics.count('/ragdoll/model'), topics.count('/ragdoll/label')), (runs, 1))
            replayed = subprocess.run([lab, 'replay', os.path.join(first, row['bag'])],
                                      timeout=2 * LIMIT, stdout=subprocess.PIPE,
                                      universal_newlines=True)
            self.assertEqual(replayed.returncode, 0, replayed.stdout)
            same = [int(n) for n in re.findall(r'identical in (\d+) states', replayed.stdout)]
            self.assertEqual((len(same), sum(same)), (runs, 181), replayed.stdout)

    def test_a_bag_plays_without_the_node(self):
        path = os.path.join(self.record_falls('falls', falls=1, seed=10), 'fall_000010.bag')
        with rosbag.Bag(path) as bag:
            states = [m for _, m, _ in bag.read_messages(['/ragdoll/state'])]
        launch = self.start('playback.launch', 'bag:=falls/fall_000010.bag', 'rviz:=false',
                            'rate:=0.5', 'loop:=true')
        markers, frames = Inbox('/ragdoll/markers', MarkerArray), Inbox('/tf', TFMessage)

        def sticks():
            """Where the drawn sticks' ends are."""
            return {tuple((p.x, p.y, p.z) for p in m.points) for a in markers.all()
                    for m in a.markers if m.ns == 'sticks'}

        def pelvis():
            """Its heights."""
            return [t.transform.translation.z for m in frames.all() for t in m.transforms
                    if t.child_frame_id == 'ragdoll/pelvis'] or [0.6]
        wait_for(lambda: len(sticks()) > 30, 'moving sticks')
        wait_for(lambda: max(pelvis()) > 0.8 and min(pelvis()) < 0.5, 'a fall')
        self.assertNotIn('/ragdoll/poke', [s for s, _ in rospy.get_master().getSystemState()[2][2]])
        self.assertTrue(rospy.get_param('/use_sim_time'))
        self.end(launch)
        self.assertFalse(rospy.has_param('/use_sim_time'))
        # What was drawn is what was recorded, nothing between and nothing else.
        recorded = [set(points(s.ragdolls[0])) for s in states]
        for drawn in sticks():
            self.assertTrue(any(set(drawn) <= at for at in recorded))
        self.start('playback.launch', 'bag:=falls/fall_000010.bag', 'rviz:=false',
                   'rate:=2').wait(LONG)  # it ends with the bag
        self.assertFalse(rospy.has_param('/use_sim_time'))  # whoever comes next has a clock
        self.assertNotIn('/ragdoll', rosnode.get_node_names())

    def record(self, node, *arguments):
        """Topics of the bag that this launch records of the node."""
        path = os.path.join(self.folder, 'my dir', 'my run.bag')
        os.mkdir(os.path.dirname(path))
        launch = self.start(*arguments)
        client = Client(node)

        def listeners():
            return dict(rospy.get_master().getSystemState()[2][1])[node + '/state']
        wait_for(lambda: rospy.names.namespace(node) + 'record' in listeners(), 'the recorder')
        seen = len(client.states.all())
        wait_for(lambda: len(client.states.all()) > seen + 60, 'states to record')
        self.end(launch)
        with rosbag.Bag(path) as bag:
            return {topic for topic, _, _ in bag.read_messages()}

    def test_a_bag_may_have_spaces_in_its_path(self):
        topics = self.record('/ragdoll', 'ragdoll.launch', 'rviz:=false', 'bag:=my dir/my run.bag')
        self.assertEqual(topics, {'/tf', '/ragdoll/state', '/ragdoll/model'})

    def test_a_bag_of_a_node_in_a_namespace(self):
        """Is recorded under its name, and plays by it."""
        path = os.path.join(self.folder, 'sim.launch')
        with open(path, 'w') as file:
            file.write('''<launch><group ns="sim"><include file="$(find ragdoll)/launch/ragdoll.launch">
                <arg name="rviz" value="false"/><arg name="bag" value="my dir/my run.bag"/>
                </include></group></launch>''')
        topics = self.record('/sim/ragdoll', path)
        self.assertEqual(topics, {'/tf', '/sim/ragdoll/state', '/sim/ragdoll/model'})
        for node in ('sim/ragdoll', '/sim/ragdoll'):
            launch = self.start('playback.launch', 'bag:=my dir/my run.bag', 'rviz:=false', 'node:=' + node)
            drawn = Inbox('/ragdoll/markers', MarkerArray)
            drawn.first(lambda a: any(m.ns == 'sticks' for m in a.markers), 'the body')
            self.assertEqual(drawn.all()[-1]._connection_header['callerid'], '/sim/ragdoll')
            self.end(launch)
            drawn.subscriber.unregister()

    def gripper(self, script, name, **parameters):
        """push.py or rescue.py."""
        program = roslib.packages.find_node('ragdoll_sim', script)[0]
        gripper = subprocess.Popen([program, '__name:=' + name] + ['_%s:=%s' % p for p in parameters.items()],
                                   stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
        self.addCleanup(lambda: gripper.poll() is None and gripper.kill())
        return gripper, lambda: gripper.communicate(timeout=LONG)[0]

    def test_a_gripper_takes_the_hand_of_any_node(self):
        """Of the second body, in other frames than the usual ones."""
        for script, scene in (('push.py', 'push'), ('rescue.py', 'rescue')):
            with self.subTest(script):
                client = start_node(self, 'second_' + scene, scene=with_another(scene),
                                    world_frame='map', frame_prefix=scene + '/')
                gripper, said = self.gripper(script, scene, node=client.node, hand='ben/right_hand',
                                             speed=2, rounds=1)
                pictures = Inbox('/rescue/gripper', MarkerArray) if scene == 'rescue' else None
                told = said()
                self.assertEqual(gripper.returncode, 0, told)
                self.assertIn('ben/right_hand is held at gripper', told)
                heights = [[position(client.model, s, 'right_hand', ragdoll)[2] for s in client.states.all()]
                           for ragdoll in (0, 1)]
                self.assertLess(max(heights[0]), 0.5)
                self.assertGreater(max(heights[1]), 0.8)  # it is held up
                if pictures:  # its force is felt
                    self.assertTrue([m for a in pictures.all() for m in a.markers
                                     if m.type == Marker.ARROW and m.action == Marker.ADD])

    def test_a_gripper_tells_which_parameter_is_wrong(self):
        start_node(self, 'ragdoll', scene='weightless')
        for script in ('push.py', 'rescue.py'):
            for name, value in (('speed', '0'), ('speed', '-1'), ('speed', '.nan'), ('speed', 'fast'),
                                ('rounds', '-1'), ('rounds', '1.5'), ('hand', 'tail'), ('hand', '5')):
                with self.subTest(script=script, name=name, value=value):
                    gripper, said = self.gripper(script, 'wrong', **{name: value})
                    told = said()
                    rospy.delete_param('/wrong')
                    self.assertEqual(gripper.returncode, 1, told)
                    self.assertRegex(told, '^.*parameter /wrong/%s: is %s; it must be .*\n$' %
                                     (name, value.strip('.')))


if __name__ == '__main__':
    rospy.init_node('demos_test')
    rostest.rosrun('ragdoll_sim', 'demos', DemosTest, sys.argv)
