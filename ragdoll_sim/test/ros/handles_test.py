#!/usr/bin/python3
"""~handles, dragged as rviz drags them."""

import math
import sys
import threading
import unittest

import rospy
import rostest
import tf2_ros
from client import Client, Inbox, bits, momentum, position, start_node, wait_for
from geometry_msgs.msg import Point, TransformStamped, Vector3
from ragdoll_msgs.msg import PokeEvent
from visualization_msgs.msg import InteractiveMarkerFeedback as Feedback
from visualization_msgs.msg import InteractiveMarkerInit, InteractiveMarkerUpdate

FLOATING = '''
gravity: [0, 0, 0]
ragdolls:
  - {name: ragdoll, model: human_lumped, position: [0, 0, 2]}
solver: {step: 0.001}
'''
# Heavy ends, no joints: the handle in the middle feels different masses along and across.
CHAIN = '''
gravity: [0, 0, 0]
solver: {step: 0.001}
ragdolls:
  - name: chain
    position: [0, 0, 2]
    model:
      particles:
        a: {position: [0, 0, 0], mass: 5}
        b: {position: [0.3, 0, 0.4], mass: 0.5}
        c: {position: [0.3, 0.5, 0.8], mass: 20}
      sticks: [[a, b], [b, c]]
'''
STEP = 0.001  # [s]
RATE = 15.0  # [1/s] of the spring, core/pull.h
HAND = 'ragdoll/right_hand'


def left(time):
    """Share of the way that is left on a critically damped spring, from rest."""
    return (1 + RATE * time) * math.exp(-RATE * time)


class Mouse(threading.Thread):
    """Holds a handle and says so ten times a second, until told not to."""

    def __init__(self, publisher):
        super().__init__(daemon=True)
        self.publisher, self.held = publisher, None
        self.start()

    def send(self, event, handle, at, frame='world'):
        message = Feedback(client_id='/rviz', marker_name=handle, event_type=event)
        message.header.frame_id = frame
        message.pose.position = Point(*at)
        message.pose.orientation.w = 1
        self.publisher.publish(message)

    def drag(self, handle, at, frame='world'):
        self.send(Feedback.MOUSE_DOWN, handle, at, frame)
        self.send(Feedback.POSE_UPDATE, handle, at, frame)
        self.held = (handle, at, frame)

    def let_go(self, handle, at):
        self.held = None
        self.send(Feedback.MOUSE_UP, handle, at)

    def run(self):
        while True:
            held = self.held
            if held:
                self.send(Feedback.KEEP_ALIVE, *held)
            rospy.rostime.wallsleep(0.1)


class HandlesTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.client = Client()
        publisher = rospy.Publisher('/ragdoll/handles/feedback', Feedback, queue_size=100)
        wait_for(lambda: publisher.get_num_connections() > 0, 'the node')
        # They follow the bodies only while someone listens.
        cls.init = Inbox('/ragdoll/handles/update_full', InteractiveMarkerInit)
        cls.updates = Inbox('/ragdoll/handles/update', InteractiveMarkerUpdate)
        cls.mouse = Mouse(publisher)
        cls.broadcaster = tf2_ros.StaticTransformBroadcaster()
        t = TransformStamped()
        t.header.frame_id, t.child_frame_id = 'world', 'camera'
        t.transform.translation = Vector3(1, 2, 3)
        t.transform.rotation.z = t.transform.rotation.w = math.sqrt(0.5)
        cls.broadcaster.sendTransform(t)

    def setUp(self):
        self.assertTrue(self.client.call_pause(True).success)
        self.scene(FLOATING, HAND)

    def tearDown(self):
        self.mouse.let_go(HAND, (0, 0, 0))

    def scene(self, yaml, handle):
        self.client.load(yaml=yaml)
        wait_for(lambda: handle in self.handles(), 'the handle ' + handle)

    def handles(self):
        return [m.name for m in self.init.all()[-1].markers] if self.init.all() else []

    def at(self, particle):
        """Where the particle is now."""
        return position(self.client.model, self.client.step(0), particle)

    def begin(self, target, frame='world', handle=HAND):
        """Drags a handle; the first step at which it is pulled."""
        seen = len(self.client.told())
        self.mouse.drag(handle, target, frame)

        def pulled():
            self.client.step(1)
            return self.client.told()[seen:]
        return wait_for(pulled, 'the pull')[0].step

    def released(self):
        """A state that was reached without a pull in its last steps."""
        def free():
            seen = len(self.client.told())
            state = self.client.step(20)
            return state if not self.client.told()[seen:] else None
        return wait_for(free, 'a release')

    def test_pulls_by_the_critically_damped_law(self):
        self.scene(CHAIN, 'chain/b')
        start = self.at('b')
        target = (start[0] + 0.1, start[1] - 0.05, start[2] + 0.05)
        way = [b - a for a, b in zip(start, target)]
        first = self.begin(target, handle='chain/b')
        for _ in range(20):
            step = self.client.step(40).step
            rest = [b - a for a, b in zip(self.at('b'), target)]
            share = sum(a * b for a, b in zip(rest, way)) / sum(a * a for a in way)
            self.assertAlmostEqual(share, left((step - first) * STEP), delta=0.02)
        self.assertLess(max(abs(a) for a in rest), 1e-3)
        self.mouse.let_go('chain/b', target)

    def test_a_hand_arrives_and_hardly_overshoots_with_its_joints_at_their_limits(self):
        start = self.at('right_hand')
        target = (start[0] + 0.2, start[1] - 0.1, start[2] + 0.2)
        self.begin(target)
        for _ in range(20):
            self.client.step(40)
            rest = [b - a for a, b in zip(self.at('right_hand'), target)]
            share = sum(a * (b - c) for a, b, c in zip(rest, target, start)) / 0.09
            self.assertGreater(share, -0.05)
        self.assertLess(max(abs(a) for a in rest), 0.002)

    def test_each_step_is_told_and_replays_to_the_same_bits(self):
        replay = rospy.Publisher('/ragdoll/poke_replay', PokeEvent, queue_size=1000)
        wait_for(lambda: replay.get_num_connections() > 0, 'the node')
        seen = len(self.client.told())
        at = self.at('right_hand')
        first = self.begin((at[0] + 0.3, at[1], at[2]))
        self.client.step(50)
        self.mouse.drag(HAND, (at[0], at[1] - 0.2, at[2] + 0.4))
        last = self.client.step(50).step
        self.mouse.let_go(HAND, at)
        state = self.released()
        events = self.client.told()[seen:]
        steps = [e.step for e in events]
        self.assertEqual(steps, list(range(first, first + len(steps))))
        self.assertGreaterEqual(steps[-1], last - 1)
        self.assertEqual({e.body_name for e in events}, {HAND})
        self.client.restart()
        told = len(self.client.told())
        for event in events:
            replay.publish(event)
        wait_for(lambda: len(self.client.told()) >= told + len(events), 'the replay')
        self.assertEqual(bits(self.client.step(state.step)), bits(state))

    def test_mouse_up_ends_it(self):
        at = self.at('right_hand')
        self.begin((at[0] + 5, at[1], at[2]))
        self.client.step(20)
        self.mouse.let_go(HAND, at)
        before = momentum(self.client.model, self.released())
        after = momentum(self.client.model, self.client.step(200))
        self.assertGreater(before[0], 1)
        for a, b in zip(before, after):
            self.assertAlmostEqual(a, b, delta=1e-8)

    def test_the_watchdog_ends_it(self):
        at = self.at('right_hand')
        self.client.call_pause(False)
        self.mouse.drag(HAND, (at[0], at[1], at[2] + 0.3))
        wait_for(lambda: self.client.pokes.all() and self.pulled_lately(), 'the pull')

        def goes_on():
            # Two seconds, twice as long as the watchdog's; a machine that stalls does not do so always.
            self.mouse.drag(HAND, (at[0], at[1], at[2] + 0.3))
            begin = self.client.states.all()[-1].step
            wait_for(lambda: self.client.states.all()[-1].step > begin + 500, 'two seconds')
            return self.pulled_lately()
        wait_for(goes_on, 'a pull that goes on while it is held')
        self.mouse.held = None  # as if rviz had died
        wait_for(lambda: not self.pulled_lately(), 'the watchdog')

    def pulled_lately(self):
        return self.client.pokes.all()[-1].step > self.client.states.all()[-1].step - 100

    def test_a_clearing_ends_it_until_the_mouse_moves(self):
        at = self.at('right_hand')
        self.begin((at[0], at[1], at[2] + 0.3))
        self.mouse.held = None
        self.assertTrue(self.client.call_clear().success)
        seen = len(self.client.told())
        for _ in range(3):  # it is still held
            self.mouse.send(Feedback.KEEP_ALIVE, HAND, (at[0], at[1], at[2] + 0.3))
        # In order: when this is pulled, those have been heard.
        other = 'ragdoll/left_hand'
        self.mouse.drag(other, (at[0], -at[1], at[2]))

        def pulled():
            self.client.step(1)
            return {e.body_name for e in self.client.told()[seen:]}
        self.assertEqual(wait_for(pulled, 'the other hand'), {other})
        self.mouse.let_go(other, at)

    def test_feedback_in_another_frame(self):
        # The camera stands at (1, 2, 3) and looks along y: its (a, b, c) is the world's (1 - b, 2 + a, 3 + c).
        at = self.at('right_hand')
        target = (at[0] + 0.2, at[1], at[2] + 0.2)
        self.begin((target[1] - 2, 1 - target[0], target[2] - 3), 'camera')
        self.client.step(1000)
        for a, b in zip(self.at('right_hand'), target):
            self.assertAlmostEqual(a, b, delta=0.005)

    def test_bad_feedback_changes_nothing(self):
        nan = float('nan')
        seen = len(self.client.told())
        at = self.at('right_hand')
        far = (at[0] + 1, at[1], at[2])
        for args in ((HAND, (nan, 0, 0)), (HAND, (0, 2e9, 0)), ('ragdoll/tail', far), ('ragdoll/torso', far),
                     ('', far), (HAND, far, 'nowhere')):
            self.mouse.send(Feedback.MOUSE_DOWN, *args)
            self.mouse.send(Feedback.POSE_UPDATE, *args)
        self.mouse.send(Feedback.KEEP_ALIVE, HAND, far)  # of a handle that nobody holds
        self.mouse.send(Feedback.MOUSE_UP, 'ragdoll/tail', far)
        # In order: when this is pulled, all of the above has been heard.
        self.mouse.drag('ragdoll/left_hand', (at[0], -at[1], at[2]))
        wait_for(lambda: self.client.step(1) and self.client.told()[seen:], 'the pull')
        self.client.step(20)
        self.assertEqual({e.body_name for e in self.client.told()[seen:]}, {'ragdoll/left_hand'})
        self.mouse.let_go('ragdoll/left_hand', at)

    def test_handles_follow_the_body_and_the_scene(self):
        names = set(self.handles())
        self.assertEqual(names, {'ragdoll/' + p for p in self.client.model.ragdolls[0].particles
                                 if 'hip' not in p})
        self.client.poke('head', (300, 0, 0), duration=0.2)
        self.client.step(200)
        expected = self.at('head')

        def there():
            poses = [p for u in self.updates.all() for p in u.poses + u.markers
                     if p.name == 'ragdoll/head']
            p = poses[-1].pose.position if poses else Point()
            return max(abs(a - b) for a, b in zip((p.x, p.y, p.z), expected)) < 1e-12
        wait_for(there, "the head's handle")
        # One that is let go returns to the body, although nothing moves while paused.
        seen = len(self.updates.all())
        self.mouse.drag('ragdoll/head', [c + 1 for c in expected])
        self.mouse.let_go('ragdoll/head', expected)
        wait_for(lambda: there() and any(p.name == 'ragdoll/head' for u in self.updates.all()[seen:]
                                         for p in u.poses), 'the handle back at the head')
        # Two bodies have all of theirs, many have the tips of their limbs.
        self.client.load(path='two')
        wait_for(lambda: 'anna/left_knee' in self.handles(), "the other scene's handles")
        self.assertEqual(len(self.handles()), 2 * len(names))
        self.client.load(path='crowd')
        wait_for(lambda: 'crowd_19/head' in self.handles(), "the crowd's handles")
        self.assertEqual({h.split('/')[1] for h in self.handles()},
                         {'head', 'left_hand', 'right_hand', 'left_foot', 'right_foot'})

    def test_who_listens_to_all_handles_alone_and_late_has_them(self):
        client = start_node(self, 'full', scene='fall', start_paused='true', tf_bodies='none')

        def listen():
            full = Inbox('/full/handles/update_full', InteractiveMarkerInit)
            self.addCleanup(full.subscriber.unregister)
            full.first(lambda m: True, 'handles')
            return full
        full = listen()
        self.assertIn('ragdoll/head', {m.name for m in full.all()[0].markers})
        expected = position(client.model, client.step(30), 'head')

        def is_there(message):
            at = next(m.pose.position for m in message.markers if m.name == 'ragdoll/head')
            return max(abs(a - b) for a, b in zip((at.x, at.y, at.z), expected)) < 1e-12
        full.first(is_there, "the head's handle")
        full.subscriber.unregister()
        client.load(path='two')
        self.assertIn('anna/head', {m.name for m in listen().all()[0].markers})


if __name__ == '__main__':
    rospy.init_node('handles_test')
    rostest.rosrun('ragdoll_sim', 'handles', HandlesTest, sys.argv)
