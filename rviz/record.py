#!/usr/bin/python3
"""Records the README's moving picture: the stairs, then a push with the mouse, in rviz.

record.py OUT.gif [--width PIXELS]. Needs an environment with the packages, Xvfb, ffmpeg and xdotool
(apt-get install xvfb ffmpeg xdotool). Starts a roscore, a display and rviz of its own. The simulation runs slowly and
the picture is played faster, so that software GL keeps up.
"""

import argparse
import math
import os
import subprocess
import tempfile
import time

import rosgraph
import rospy
from ragdoll_msgs.msg import Model, State
from std_srvs.srv import SetBool, Trigger

HERE = os.path.dirname(os.path.abspath(__file__))
PORT, DISPLAY = 11983, ':93'
SLOW = 0.125        # simulated per wall time
RATE = 2.5          # [Hz] of pictures in wall time: 20 per simulated second
LEFT, TOP, WIDTH, HEIGHT = 16, 62, 1098, 688  # [pixels] of the view, within rviz's window
POKE = (465, 42)    # [pixels] the tool's button
FALL, PUSH, UNTIL_PUSH = 2.6, 2.6, 0.3  # [s] of simulated time
STRENGTH = 2500     # [N] for 0.1 s: what the tool gives is seen
# Of rviz/ragdoll.rviz: Orbit.
FOCUS, DISTANCE, YAW, PITCH, FIELD = (0.65, 0, 1.05), 6, 5.05, 0.28, 0.785398


def pixel(point):
    """Where the view shows a point [m, world], within the view."""
    d = [point[i] - FOCUS[i] for i in range(3)]
    sy, cy, sp, cp = math.sin(YAW), math.cos(YAW), math.sin(PITCH), math.cos(PITCH)
    depth = DISTANCE - (d[0] * cp * cy + d[1] * cp * sy + d[2] * sp)
    right, up = -d[0] * sy + d[1] * cy, -d[0] * sp * cy - d[1] * sp * sy + d[2] * cp
    scale = HEIGHT / 2 / math.tan(FIELD / 2) / depth
    return WIDTH / 2 + scale * right, HEIGHT / 2 - scale * up


def wait_for(what, found, seconds=90):
    end = time.time() + seconds
    while time.time() < end:
        answer = found()
        if answer:
            return answer
        time.sleep(0.2)
    raise SystemExit('record.py: %s: not there after %d s' % (what, seconds))


def output(*command):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, universal_newlines=True)
    return done.stdout.strip() if done.returncode == 0 else ''


def window():
    """Number and corner of rviz's window, once it has been laid out."""
    for number in output('xdotool', 'search', '--onlyvisible', '--name', 'RViz').split():
        place = dict(line.split('=') for line in
                     output('xdotool', 'getwindowgeometry', '--shell', number).split() if '=' in line)
        if int(place.get('WIDTH', 0)) > 1000:
            return number, int(place['X']), int(place['Y'])
    return None


def film(at, seconds, out):
    """Pictures of the view for so much simulated time."""
    return subprocess.Popen(
        ['ffmpeg', '-loglevel', 'error', '-y', '-f', 'x11grab', '-draw_mouse', '1', '-framerate', str(RATE),
         '-video_size', '%dx%d' % (WIDTH, HEIGHT), '-i', '%s+%d,%d' % (DISPLAY, at[0] + LEFT, at[1] + TOP),
         '-t', str(seconds / SLOW), '-c:v', 'ffv1', out], stdin=subprocess.DEVNULL)


def middle_of_trunk():
    model = rospy.wait_for_message('/ragdoll/model', Model).ragdolls[0]
    state = rospy.wait_for_message('/ragdoll/state', State).ragdolls[0]
    points = [p for name, p in zip(model.particles, state.positions) if 'shoulder' in name or 'hip' in name]
    return [sum(getattr(p, axis) for p in points) / len(points) for axis in 'xyz']


def record(folder):
    _, x, y = wait_for('the window of rviz', window)
    wait_for('a subscriber of ~state', lambda: '/rviz' in output('rostopic', 'info', '/ragdoll/state'))
    time.sleep(5)  # until rviz has drawn what stands still
    reset = rospy.ServiceProxy('/ragdoll/reset', Trigger)
    pause = rospy.ServiceProxy('/ragdoll/pause', SetBool)
    output('xdotool', 'mousemove', str(x + POKE[0]), str(y + POKE[1]), 'click', '1')
    output('xdotool', 'mousemove', str(x + LEFT + WIDTH - 60), str(y + TOP + HEIGHT - 60))
    reset()
    first = film((x, y), FALL, os.path.join(folder, '0.mkv'))
    pause(False)
    first.wait()
    pause(True)
    reset()
    time.sleep(2)
    second = film((x, y), PUSH, os.path.join(folder, '1.mkv'))
    pause(False)
    time.sleep(UNTIL_PUSH / SLOW)
    right, down = pixel(middle_of_trunk())
    output('xdotool', 'mousemove', str(int(x + LEFT + right)), str(int(y + TOP + down)), 'sleep', '0.4', 'click', '1')
    second.wait()


def view(folder):
    """The shipped view, with a stronger push."""
    with open(os.path.join(HERE, 'ragdoll.rviz')) as file:
        text = file.read()
    path = os.path.join(folder, 'record.rviz')
    with open(path, 'w') as file:
        file.write(text.replace('Strength: 600', 'Strength: %d' % STRENGTH))
    return path


def join(parts, options):
    play = 'setpts=%g*PTS' % SLOW
    subprocess.run(
        ['ffmpeg', '-loglevel', 'error', '-y', '-i', parts[0], '-i', parts[1], '-filter_complex',
         '[0]%s[a];[1]%s[b];[a][b]concat=n=2,fps=%g,scale=%d:-1:flags=lanczos,split[c][d];'
         '[d]palettegen=max_colors=128:stats_mode=full[p];[c][p]paletteuse=dither=none:diff_mode=rectangle'
         % (play, play, RATE / SLOW, options.width), options.out], check=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    parser.add_argument('out')
    parser.add_argument('--width', type=int, default=720, help='[pixels]')
    options = parser.parse_args()
    os.environ.update(ROS_MASTER_URI='http://127.0.0.1:%d' % PORT, ROS_IP='127.0.0.1', DISPLAY=DISPLAY,
                      LIBGL_ALWAYS_SOFTWARE='1')
    quiet = {'stdout': subprocess.DEVNULL, 'stderr': subprocess.DEVNULL}
    screen = subprocess.Popen(['Xvfb', DISPLAY, '-screen', '0', '1440x860x24', '-nolisten', 'tcp'], **quiet)
    started = [screen]
    folder = tempfile.TemporaryDirectory()
    try:
        time.sleep(2)
        started.append(subprocess.Popen(['roslaunch', '-p', str(PORT), 'ragdoll', 'ragdoll.launch', 'paused:=true',
                                         'rviz:=false', 'realtime_factor:=%g' % SLOW], **quiet))
        wait_for('the master', rosgraph.is_master_online)
        rospy.init_node('record', disable_signals=True)
        rospy.wait_for_service('/ragdoll/reset', 60)
        started.append(subprocess.Popen(['sh', os.path.join(HERE, 'with_plugins.sh'), 'rviz', '-d', view(folder.name),
                                         '-f', 'world'], **quiet))
        record(folder.name)
        join([os.path.join(folder.name, name) for name in ('0.mkv', '1.mkv')], options)
    finally:
        for process in reversed(started):
            process.terminate()
            process.wait()
        folder.cleanup()
    print('%s: %.1f MB' % (options.out, os.path.getsize(options.out) / 1e6))


if __name__ == '__main__':
    main()
