#!/usr/bin/python3
"""state_to_markers draws of a bag what the node drew when it was recorded."""

import copy
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

import roslib.packages
import rospy
import rostest
from bags import Recorder
from client import Client, Inbox, position, wait_for
from ragdoll_msgs.msg import FollowedFrame, Model, PokeEvent, State
from rosgraph_msgs.msg import Log
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import MarkerArray

TOPICS = ['/ragdoll/' + name for name in ('model', 'state', 'pokes')]

BOX = '''
ragdolls: [{name: ragdoll, model: human, position: [0, 0, 2]}]
obstacles: [{type: box, frame: paddle, position: [0.5, 0, 0], size: [0.1, 1, 1]}]
solver: {step: 0.001}
'''


def numbers(message):
    """(ns, id) -> points, pose, scale, colour and kind; without pokes, and what clears all."""
    return {(m.ns, m.id): ([(p.x, p.y, p.z) for p in m.points], m.pose, m.scale, m.color, m.type)
            for m in message.markers if m.ns not in ('', 'pokes')}


class PlaybackTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.client = Client()
        cls.client.restart()

    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)

    def record(self):
        """A bag: some steps, a poke that goes on, a last state."""
        path = os.path.join(self.folder, 'run.bag')
        recorder = Recorder(path, '/ragdoll', TOPICS)
        self.client.restart()
        self.client.step(60)
        self.assertTrue(self.client.poke('head', (0, 80, 0), duration=-1).success)
        for _ in range(10):
            self.last = self.client.step(4)
        recorder.stop()
        return path

    def picture(self, head):
        """All markers as the node draws them for a new listener with the head there."""
        drawn = Inbox('/ragdoll/markers', MarkerArray)
        self.addCleanup(drawn.subscriber.unregister)
        found, new = {}, drawn.reader()

        def whole():
            for message in new():
                now = numbers(message)
                if head in now.get(('sticks', 0), [[]])[0]:
                    found.update(now)
            return ('obstacles', 0) in found
        wait_for(whole, 'the node to draw the last state')
        return found

    def play(self, path):
        program = roslib.packages.find_node('rosbag', 'play')[0]
        player = subprocess.Popen(
            [program, '--quiet', '--keep-alive', '--wait-for-subscribers', path]
            + ['%s:=%s' % (topic, topic.replace('ragdoll', 'played')) for topic in TOPICS],
            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
        self.addCleanup(player.kill)

    def test_the_picture_is_the_one_that_was_drawn(self):
        path = self.record()
        head = position(self.client.model, self.last, 'head')
        expected = self.picture(head)
        played = Inbox('/played/markers', MarkerArray)
        frames = Inbox('/tf', TFMessage)
        self.play(path)

        sticks = expected[('sticks', 0)]
        last = played.first(lambda m: numbers(m).get(('sticks', 0)) == sticks,
                            'the last state, drawn alike')
        keys, new = set(), played.reader()

        def alike():
            keys.update(key for m in new() for key in numbers(m))
            return keys == set(expected)
        wait_for(alike, 'the markers %s' % sorted(expected))
        for message in played.all():
            for key, value in numbers(message).items():
                if key[0] == 'obstacles':
                    self.assertEqual(value, expected[key])
        # A slow listener misses pictures, so one with an arrow is asked for again: the poke goes on.
        state = copy.deepcopy(self.last)
        tell_state = rospy.Publisher('/played/state', State, queue_size=10)

        newly_played = played.reader()

        def new_arrows():
            state.step += 1
            tell_state.publish(state)
            return [m for message in newly_played() for m in message.markers if m.ns == 'pokes']
        arrows = wait_for(new_arrows, 'an arrow for the poke')
        self.assertGreater(arrows[-1].points[1].y - arrows[-1].points[0].y, 0.3)

        # The node still publishes the same frames, so the relay keeps silent.
        new_frames = frames.reader()

        def silent():
            new_frames()
            names = []

            def enough():
                names.extend(m._connection_header['callerid'] for m in new_frames())
                return names.count('/ragdoll') > 30
            wait_for(enough, 'frames')
            return '/played' not in names
        wait_for(silent, 'silence of the relay')

    def test_an_obstacle_is_where_followed_tells(self):
        """No TF has the frame: where it is in each step is in the bag."""
        model = copy.deepcopy(Inbox('/ragdoll/model', Model).first(lambda m: True, 'a model'))
        state = self.client.restart()
        tell_model, tell_state, tell_followed = (
            rospy.Publisher('/told/' + name, kind, latch=True, queue_size=1)
            for name, kind in (('model', Model), ('state', State), ('followed', FollowedFrame)))
        model.scene_yaml = BOX
        tell_model.publish(model)
        drawn = Inbox('/told/markers', MarkerArray)
        followed = FollowedFrame(run=state.run, number=1, step=100, frame='paddle', age=0.01,
                                 duration=0.1)
        followed.start.position.x, followed.goal.position.x = 1.0, 3.0
        followed.start.orientation.w = followed.goal.orientation.w = 1
        for step, x in ((100, 1.2), (125, 1.7), (200, 3.0)):  # of the frame, 1 ms a step
            state.step, state.time = step, 0.001 * step

            def there():
                tell_followed.publish(followed)
                tell_state.publish(state)
                boxes = [m for a in drawn.all()[-1:] for m in a.markers if m.ns == 'obstacles']
                return boxes and abs(boxes[0].pose.position.x - (x + 0.5)) < 1e-9
            wait_for(there, 'the box at step %d' % step)

    def test_what_comes_before_the_model_or_after_its_state_is_drawn(self):
        """Topics come in no common order: told by hand, first the poke, last the model."""
        model = copy.deepcopy(Inbox('/ragdoll/model', Model).first(lambda m: True, 'a model'))
        state = self.client.restart()
        state.step = 100
        tell_model, tell_state, tell_poke = (
            rospy.Publisher('/early/' + name, kind, queue_size=10)
            for name, kind in (('model', Model), ('state', State), ('pokes', PokeEvent)))
        for publisher in (tell_model, tell_state, tell_poke):
            wait_for(lambda p=publisher: p.get_num_connections() > 0, 'the relay')
        new_lines = Inbox('/rosout', Log).reader()

        def lengths():
            """[m] of all arrows so far, along y"""
            found.update(round(m.points[1].y - m.points[0].y, 9)
                         for a in newly_drawn() for m in a.markers if m.ns == 'pokes')
            return found
        poke = PokeEvent(run=state.run, step=40, body_name='head')
        poke.duration.secs = -1
        poke.force.y = 50
        tell_poke.publish(poke)

        def heard():
            tell_state.publish(state)
            return any(m.name == '/early' and 'no ~model' in m.msg for m in new_lines())
        wait_for(heard, 'the state without model')
        tell_model.publish(model)
        drawn = Inbox('/early/markers', MarkerArray)
        found, newly_drawn = set(), drawn.reader()
        drawn.first(lambda a: len(a.markers) > 0, 'the state that came before the model')

        def early_arrow():  # a slow listener misses pictures, so it is told again
            state.step += 1
            tell_state.publish(state)
            return len(lengths()) == 1
        wait_for(early_arrow, 'the arrow of what came before the model')
        poke.force.y = 100

        def late_arrow():
            tell_poke.publish(poke)
            return len(lengths()) == 2
        wait_for(late_arrow, 'the arrow of what came after the state')

    def tell_by_hand(self, node, name, more=''):
        """The node's body at its start by another name, its scene with `more`, told to the relay of `node`. Returns the
        state, and what tells it again and gives the frames of that name so far."""
        model = copy.deepcopy(Inbox('/ragdoll/model', Model).first(lambda m: True, 'a model'))
        state = self.client.restart()
        new_frames = Inbox('/tf', TFMessage).reader()
        tell_model = rospy.Publisher(node + '/model', Model, latch=True, queue_size=1)
        tell_state = rospy.Publisher(node + '/state', State, latch=True, queue_size=1)
        model.scene_yaml = model.scene_yaml.replace('name: ragdoll', 'name: ' + name) + more
        state.ragdolls[0].name = name
        tell_model.publish(model)
        tree = {}

        def frames():
            tell_state.publish(state)
            tree.update((t.child_frame_id, t) for m in new_frames() for t in m.transforms
                        if t.child_frame_id.startswith(name + '/'))
            return tree
        return state, frames

    def test_frames_where_nobody_else_has_them(self):
        """A body of another name, told by hand: what the node does not publish, the relay does."""
        state, frames = self.tell_by_hand('/played', 'other')
        tree = wait_for(frames, 'the frames')
        self.assertEqual(len(tree), 17)
        root = tree['other/pelvis'].transform.translation
        hips = [position(self.client.model, state, side + '_hip') for side in ('left', 'right')]
        for value, a, b in zip((root.x, root.y, root.z), *hips):
            self.assertAlmostEqual(value, (a + b) / 2)

    def test_sensors_have_their_frames(self):
        """As the node has them: on the torso, which turns with the neck's frame."""
        _, frames = self.tell_by_hand(
            '/told', 'sensed', 'sensors: [{name: s, type: imu, segment: torso, position: [0.1, 0, 0.2]}]\n')
        wait_for(lambda: 'sensed/s' in frames(), "the sensor's frame")
        tree = frames()
        self.assertIn(tree['sensed/s'].header.frame_id, tree)
        self.assertEqual(len(tree), 18)

    def test_frames_have_the_prefix_of_the_node(self):
        """Its own frames and those that its markers are in."""
        model = Inbox('/ragdoll/model', Model).first(lambda m: True, 'a model')
        state = self.client.restart()
        new_frames = Inbox('/tf', TFMessage).reader()
        tell_model = rospy.Publisher('/prefixed/model', Model, latch=True, queue_size=1)
        tell_state = rospy.Publisher('/prefixed/state', State, latch=True, queue_size=1)
        tell_model.publish(model)
        tell_state.publish(state)
        drawn = Inbox('/prefixed/markers', MarkerArray)
        locked = drawn.first(lambda a: any(m.frame_locked for m in a.markers), 'a coat in TF frames')
        self.assertLessEqual({m.header.frame_id for m in locked.markers if m.frame_locked},
                             {'robot1/ragdoll/' + f.split('/')[1] for f in self.frames_of(new_frames)})

    def frames_of(self, new_frames):
        """What the relay and the node publish, without the prefix; the relay, with it."""
        names = {}

        def both():
            for message in new_frames():
                names.setdefault(message._connection_header['callerid'], set()).update(
                    t.child_frame_id for t in message.transforms)
            return {'/ragdoll', '/prefixed'} <= set(names)
        wait_for(both, 'frames of both')
        self.assertEqual(names['/prefixed'], {'robot1/' + f for f in names['/ragdoll']})
        return names['/ragdoll']


if __name__ == '__main__':
    rospy.init_node('playback_test')
    rostest.rosrun('ragdoll_sim', 'playback', PlaybackTest, sys.argv)
