"""What push.py and rescue.py share: a gripper that broadcasts where it is, goes straight and holds a hand."""

import re
import signal
import sys
import threading

import rospy
import tf2_ros
from geometry_msgs.msg import TransformStamped
from ragdoll_msgs.msg import Model, State
from ragdoll_msgs.srv import Attach, Detach
from std_srvs.srv import Trigger

RATE = 100.0  # [Hz] of the frames

if not hasattr(threading.Thread, 'isAlive'):  # which Debian 11's rospy asks for, but not its python has
    threading.Thread.isAlive = threading.Thread.is_alive

# rospy's own handler ends ROS within whatever the main thread does, which may hold the lock that
# the end of ROS wants: it would never come.
INTERRUPTED = threading.Event()


def check_end():
    """The end of ROS is the end of the round: neither publishing nor sleeping would tell."""
    if INTERRUPTED.is_set() or rospy.is_shutdown():
        raise rospy.ROSInterruptException('ROS ends')


def until_there(wait):
    """What wait() gives once it does not time out."""
    while True:
        check_end()
        try:
            return wait()
        except rospy.ROSInterruptException:
            raise
        except rospy.ROSException:
            continue  # not yet


class ParameterError(Exception):
    pass


def check(ok, name, value, right):
    if not ok:
        raise ParameterError('parameter %s: is %s; it must be %s' %
                             (rospy.resolve_name('~' + name), value, right))


def text(name, default):
    value = rospy.get_param('~' + name, default)
    check(isinstance(value, str) and value, name, value, 'a name, such as ' + default)
    return value


def number(name, default, kinds, least, most, right):
    value = rospy.get_param('~' + name, default)
    check(type(value) in kinds and least <= value <= most, name, value, right)
    return value


class Gripper:
    """Its frame is `gripper`; `under`: (frame, [m] below it) of those that hang under it."""

    def __init__(self, at, speed, under=()):
        self.node = rospy.resolve_name(text('node', 'ragdoll'))
        hand = text('hand', 'right_hand')
        self.speed = number('speed', speed, (int, float), 0.001, 100, 'in [0.001, 100] m/s')
        self.rounds = number('rounds', 0, (int,), 0, float('inf'), 'a whole number >= 0; 0: without end')
        self.at, self.under = at, under
        self.attach = self.service('attach', Attach)
        self.detach = self.service('detach', Detach)
        self.reset = self.service('reset', Trigger)
        self.find(hand)
        self.state = None
        rospy.Subscriber(self.node + '/state', State, self.see)
        self.broadcaster = tf2_ros.TransformBroadcaster()
        self.rate = rospy.Rate(RATE)

    def service(self, name, kind):
        """Waits for it."""
        name = self.node + '/' + name
        until_there(lambda: rospy.wait_for_service(name, timeout=0.5))
        return rospy.ServiceProxy(name, kind)

    def find(self, hand):
        """What ~model calls it, and where it stands in ~state."""
        model = until_there(lambda: rospy.wait_for_message(self.node + '/model', Model, timeout=0.5))
        self.world_frame = model.header.frame_id
        bodies = [(i, r.name, p) for i, r in enumerate(model.ragdolls) for p in r.particles]
        found = [b for b in bodies if hand in (b[2], b[1] + '/' + b[2])]
        check(found, 'hand', hand, 'one of %s; or ragdoll/particle with the ragdolls %s' % tuple(
            ', '.join(dict.fromkeys(b[i] for b in bodies)) for i in (2, 1)))
        self.ragdoll, ragdoll, particle = found[0]
        self.particle = model.ragdolls[self.ragdoll].particles.index(particle)
        self.hand = ragdoll + '/' + particle
        name = particle if self.ragdoll == 0 else ragdoll + '_' + particle
        self.holder = 'attach_' + re.sub('[^0-9A-Za-z_]', '_', name)  # as ~wrenches names it

    def see(self, state):
        self.state = state

    def tell(self):
        """Broadcasts where the gripper is; lasts 1 / RATE."""
        check_end()
        frames = [(self.world_frame, 'gripper', self.at)]
        frames += [('gripper', name, (0, 0, -below)) for name, below in self.under]
        poses = []
        for parent, child, at in frames:
            pose = TransformStamped()
            pose.header.stamp = rospy.Time.now()
            pose.header.frame_id, pose.child_frame_id = parent, child
            translation = pose.transform.translation
            translation.x, translation.y, translation.z = at
            pose.transform.rotation.w = 1
            poses.append(pose)
        self.broadcaster.sendTransform(poses)
        self.rate.sleep()

    def wait(self, seconds):
        for _ in range(int(seconds * RATE)):
            self.tell()

    def move(self, goal):
        """Straight to the goal at ~speed."""
        start = self.at
        distance = sum((g - s) ** 2 for g, s in zip(goal, start)) ** 0.5
        steps = max(1, int(distance / self.speed * RATE))
        for i in range(1, steps + 1):
            self.at = tuple(s + (g - s) * i / steps for g, s in zip(goal, start))
            self.tell()

    def hand_at(self):
        """Where the ragdoll's hand is [m, world frame], as ~state tells."""
        while self.state is None:
            self.tell()
        p = self.state.ragdolls[self.ragdoll].positions[self.particle]
        return (p.x, p.y, p.z)


def run(name, make):
    """The node: ~rounds (0: without end) of what make() returns."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: INTERRUPTED.set())
    rospy.init_node(name, disable_signals=True)
    try:
        gripper = make()
        done = 0
        while not rospy.is_shutdown() and (gripper.rounds == 0 or done < gripper.rounds):
            gripper.round()
            done += 1
    except ParameterError as wrong:
        rospy.logfatal('%s', wrong)
        sys.exit(1)
    except (rospy.ROSException, rospy.ServiceException):
        # Of a node that is ending, services and publishers fail where they stand.
        if not (INTERRUPTED.is_set() or rospy.is_shutdown()):
            raise
    finally:
        rospy.signal_shutdown('the end')
