"""What push.py and rescue.py share: a gripper that broadcasts where it is, goes straight and holds a hand."""

import signal
import threading

import rospy
import tf2_ros
from geometry_msgs.msg import TransformStamped
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


class Gripper:
    """Its frame is `gripper`; `under`: (frame, [m] below it) of those that hang under it."""

    def __init__(self, at, speed, under=()):
        self.node = rospy.get_param('~node', '/ragdoll')
        self.hand = rospy.get_param('~hand', 'right_hand')
        self.speed = rospy.get_param('~speed', speed)
        self.at, self.under = at, under
        self.frames = tf2_ros.Buffer()
        tf2_ros.TransformListener(self.frames)
        self.broadcaster = tf2_ros.TransformBroadcaster()
        self.rate = rospy.Rate(RATE)
        self.attach = self.service('attach', Attach)
        self.detach = self.service('detach', Detach)
        self.reset = self.service('reset', Trigger)

    def service(self, name, kind):
        """Waits for it."""
        while True:
            check_end()
            try:
                rospy.wait_for_service(self.node + '/' + name, timeout=0.5)
                return rospy.ServiceProxy(self.node + '/' + name, kind)
            except rospy.ROSInterruptException:
                raise
            except rospy.ROSException:
                continue  # not yet

    def tell(self):
        """Broadcasts where the gripper is; lasts 1 / RATE."""
        check_end()
        frames = [('world', 'gripper', self.at)]
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
        """Where the ragdoll's hand is [m, world], as TF tells."""
        frame = self.node.strip('/') + '/' + self.hand
        t = self.frames.lookup_transform('world', frame, rospy.Time(0)).transform.translation
        return (t.x, t.y, t.z)


def run(name, make):
    """The node: ~rounds (0: without end) of what make() returns."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: INTERRUPTED.set())
    rospy.init_node(name, disable_signals=True)
    try:
        gripper = make()
        rounds = rospy.get_param('~rounds', 0)
        done = 0
        while not rospy.is_shutdown() and (rounds == 0 or done < rounds):
            gripper.round()
            done += 1
    except (rospy.ROSException, rospy.ServiceException, tf2_ros.TransformException):
        # Of a node that is ending, services and publishers fail where they stand.
        if not (INTERRUPTED.is_set() or rospy.is_shutdown()):
            raise
    finally:
        rospy.signal_shutdown('the end')
