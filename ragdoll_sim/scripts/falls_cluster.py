#!/usr/bin/python3
"""Makes the falls of `ragdoll_lab falls` on many processes or machines, by Dask's distributed scheduler.

  falls_cluster.py --count 100000 --shard 1000 --out DIR --workers 2
  falls_cluster.py --count 100000 --shard 1000 --out DIR --scheduler HOST:8786

DIR, which all machines see, gets falls_<first>_<last>.h5 for each shard; a shard is complete or not
there. Started again the run goes on where files are missing. The data are those of one process, to the
byte, whatever the number of workers, shards or deaths. docs/data.md has dask-ssh and Slurm.
"""

import argparse
import json
import os
import shutil
import sys
import time

FALLS_FILE = 'falls_%08d_%08d.h5'
LAST_SEED = 99999999
PATIENCE = 8        # [s] until a scheduler that does not answer is not there: the user waits ten
LOOK = 0.2          # [s] between two looks at what is finished
ATTEMPTS = 20       # of a shard whose workers die


def complain(text):
    sys.exit('falls_cluster: ' + text)


def find_lab():
    """The program on this machine: $RAGDOLL_LAB, beside this script, in the workspaces, on the PATH."""
    here = os.path.dirname(os.path.abspath(__file__))
    folders = [here] + [os.path.join(p, 'lib', 'ragdoll_sim')
                        for p in os.environ.get('CMAKE_PREFIX_PATH', '').split(os.pathsep) if p]
    places = [os.environ.get('RAGDOLL_LAB', '')] + [os.path.join(f, 'ragdoll_lab') for f in folders]
    for place in places + [shutil.which('ragdoll_lab') or '']:
        if place and os.access(place, os.X_OK):
            return place
    return None


def make_shard(lab, folder, first, count, options):
    """Writes one shard, on a worker; returns how many falls it made: none if it is there already."""
    import ctypes
    import os
    import signal
    import socket
    import subprocess
    path = os.path.join(folder, 'falls_%08d_%08d.h5' % (first, first + count - 1))
    if os.path.exists(path):
        return 0
    part = os.path.join(folder, '.falls_%08d_%s_%d.h5' % (first, socket.gethostname(), os.getpid()))
    if os.path.exists(part):
        os.remove(part)
    libc = ctypes.CDLL(None)

    def die_with_worker():
        libc.prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG: a dead worker's shard is made elsewhere

    try:
        run = subprocess.run([lab, 'falls', '--quiet', '--first', str(first), '--count', str(count),
                              '--out', part] + options, stdout=subprocess.PIPE,
                             stderr=subprocess.STDOUT, preexec_fn=die_with_worker)
        if run.returncode != 0:
            raise RuntimeError(run.stdout.decode(errors='replace').strip() or
                               'ragdoll_lab falls ended with %d' % run.returncode)
        os.replace(part, path)
    finally:
        if os.path.exists(part):
            os.remove(part)
    return count


class Bar:
    """How far it is, how fast, how long yet."""

    def __init__(self, total, done):
        self.total, self.before, self.begin, self.shown = total, done, time.monotonic(), None

    def show(self, done):
        if done == self.shown:
            return
        self.shown = done
        passed = max(1e-9, time.monotonic() - self.begin)
        rate = (done - self.before) / passed
        left = '%.0f s left' % ((self.total - done) / rate) if rate > 0 else ''
        full = int(30 * done / self.total)
        sys.stderr.write('\r[%s%s] %d of %d falls, %.0f a second, %s   ' % (
            '#' * full, '.' * (30 - full), done, self.total, rate, left))
        sys.stderr.flush()

    def end(self):
        sys.stderr.write('\n')


def read_arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--count', type=int, required=True, help='how many falls')
    parser.add_argument('--shard', type=int, default=1000, help='falls in a file')
    parser.add_argument('--first', type=int, default=1, help='seed of the first fall')
    parser.add_argument('--out', required=True, help='folder for the shards')
    parser.add_argument('--merge', metavar='FILE.h5', help='links the shards into one virtual file')
    where = parser.add_mutually_exclusive_group()
    where.add_argument('--scheduler', metavar='HOST:PORT', help='of a cluster that runs')
    where.add_argument('--scheduler-file', metavar='FILE', help='the same, by its scheduler file')
    where.add_argument('--workers', type=int, default=0, help='processes to start here (all cores)')
    parser.add_argument('--seconds', type=float, default=5, help='length of a record [s]')
    parser.add_argument('--rate', type=float, default=100, help='samples per second [Hz]')
    parser.add_argument('--model', default='human', help='name or file of the model')
    parser.add_argument('--no-positions', action='store_true', help='leave positions out')
    parser.add_argument('--set', action='append', default=[], metavar='KEY=VALUE',
                        help='as of ragdoll_lab falls, such as solver.preset=fast')
    parser.add_argument('--lab', help='ragdoll_lab on the workers (as here)')
    arguments = parser.parse_args([a for a in sys.argv[1:] if not a.startswith('__')])
    if arguments.count < 1 or arguments.shard < 1 or arguments.first < 0 or arguments.workers < 0:
        parser.error('--count and --shard must be at least 1, --first and --workers at least 0')
    if arguments.first + arguments.count - 1 > LAST_SEED:
        parser.error('the seeds %d ... %d go beyond %d, the last one' % (
            arguments.first, arguments.first + arguments.count - 1, LAST_SEED))
    return arguments


def shards_of(arguments):
    """(first, count) of each."""
    end = arguments.first + arguments.count
    return [(first, min(arguments.shard, end - first))
            for first in range(arguments.first, end, arguments.shard)]


def lab_options(arguments):
    options = ['--seconds', repr(arguments.seconds), '--rate', repr(arguments.rate),
               '--model', arguments.model]
    options += ['--no-positions'] if arguments.no_positions else []
    for setting in arguments.set:
        options += ['--set', setting]
    return options


def check_folder(folder, options):
    """The folder is of these options, or has no shards yet."""
    os.makedirs(folder, exist_ok=True)
    path = os.path.join(folder, 'options.json')
    made = any(name.startswith('falls_') and name.endswith('.h5') for name in os.listdir(folder))
    if made and os.path.exists(path):
        with open(path) as file:
            before = json.load(file)
        if before != options:
            complain('%s holds falls of other options (%s): name another folder' % (
                folder, ' '.join(before)))
    with open(path + '.part', 'w') as file:
        json.dump(options, file)
    os.replace(path + '.part', path)


def connect(distributed, arguments):
    """(client, cluster or None)"""
    if not arguments.scheduler and not arguments.scheduler_file:
        cluster = distributed.LocalCluster(
            n_workers=arguments.workers or os.cpu_count(), threads_per_worker=1,
            dashboard_address=None, host='127.0.0.1', silence_logs=50)
        return distributed.Client(cluster), cluster
    name = arguments.scheduler or arguments.scheduler_file
    try:
        if arguments.scheduler_file:
            if not os.path.exists(arguments.scheduler_file):
                raise OSError('there is no such file')
            return distributed.Client(scheduler_file=arguments.scheduler_file, timeout=PATIENCE), None
        return distributed.Client(arguments.scheduler, timeout=PATIENCE), None
    except (OSError, ValueError, TimeoutError) as error:
        complain('there is no scheduler at %s (%s); dask-scheduler starts one' % (
            name, str(error).split('\n')[0] or 'no answer in %d s' % PATIENCE))


class Run:
    def __init__(self, client, arguments, options):
        self.client, self.arguments, self.options = client, arguments, options
        self.folder = os.path.abspath(arguments.out)
        self.lab = arguments.lab or find_lab()
        if not self.lab:
            complain('ragdoll_lab is not here: source the workspace, or set RAGDOLL_LAB')

    def submit(self, shard):
        return self.client.submit(make_shard, self.lab, self.folder, shard[0], shard[1],
                                  self.options, pure=False)

    def missing(self, shards):
        return [s for s in shards if not os.path.exists(
            os.path.join(self.folder, FALLS_FILE % (s[0], s[0] + s[1] - 1)))]

    def make(self, shards):
        from distributed.scheduler import KilledWorker
        left = self.missing(shards)
        total, todo = self.arguments.count, sum(count for _, count in left)
        bar, attempts, lost = Bar(total, total - todo), {}, None
        futures = {shard: self.submit(shard) for shard in left}
        try:
            while futures:
                bar.show(total - sum(count for _, count in futures))
                time.sleep(LOOK)
                for shard, future in list(futures.items()):
                    if future.status == 'finished':
                        del futures[shard]
                    elif future.status == 'error':
                        error = future.exception()
                        attempts[shard] = attempts.get(shard, 0) + 1
                        if not isinstance(error, KilledWorker) or attempts[shard] > ATTEMPTS:
                            bar.end()
                            complain(str(error))
                        futures[shard] = self.submit(shard)
                lost = None if self.client.status == 'running' else lost or time.monotonic()
                if lost and time.monotonic() - lost > PATIENCE:
                    bar.end()
                    complain('the scheduler is gone; what is finished stays: start again to go on')
            bar.show(total)
        finally:
            try:
                self.client.cancel(list(futures.values()))
            except (OSError, TimeoutError):
                pass  # the scheduler is gone, and the futures with it
        bar.end()
        if self.missing(shards):
            complain('%s does not show the shards that workers wrote: do they see the same folder?' %
                     self.folder)


def clear_parts(folder, shards):
    """What died left; only when nobody writes."""
    names = {'.falls_%08d_' % first for first, _ in shards}
    for name in os.listdir(folder):
        if name[:len('.falls_00000000_')] in names:
            os.remove(os.path.join(folder, name))


def merge(path, folder, shards):
    """One file whose groups and labels are those of the shards, by links to them."""
    import h5py
    if os.path.exists(path):
        complain('%s is there already: name another file, or remove it first' % path)
    base = os.path.dirname(os.path.abspath(path))
    part = '%s.part%d' % (path, os.getpid())
    with h5py.File(part, 'w', libver='latest') as file:
        labels, layout, row = None, None, 0
        for first, count in shards:
            shard = os.path.join(folder, FALLS_FILE % (first, first + count - 1))
            name = os.path.relpath(shard, base)
            with h5py.File(shard, 'r') as source:
                if layout is None:
                    labels = source['labels'].dtype
                    layout = h5py.VirtualLayout(shape=(sum(n for _, n in shards),), dtype=labels)
                    file.attrs.update(source.attrs)
                for seed in source['falls']:
                    file['falls/' + seed] = h5py.ExternalLink(name, 'falls/' + seed)
            layout[row:row + count] = h5py.VirtualSource(name, 'labels', shape=(count,), dtype=labels)
            row += count
        file.create_virtual_dataset('labels', layout)
    os.replace(part, path)


def main():
    arguments = read_arguments()
    try:
        import dask
        import distributed
        if arguments.merge:
            import h5py
            assert h5py
    except ImportError as error:
        complain('needs %s: install python3-distributed%s' % (
            error.name, ' and python3-h5py' if arguments.merge else ''))
    dask.config.set({'distributed.scheduler.allowed-failures': ATTEMPTS,
                     'distributed.comm.timeouts.connect': '%ds' % PATIENCE,
                     'distributed.admin.log-format': '%(message)s'})
    options, shards = lab_options(arguments), shards_of(arguments)
    if arguments.merge and os.path.exists(arguments.merge):
        complain('%s is there already: name another file, or remove it first' % arguments.merge)
    client, cluster = connect(distributed, arguments)
    try:
        check_folder(arguments.out, options)
        Run(client, arguments, options).make(shards)
        clear_parts(arguments.out, shards)
    except KeyboardInterrupt:
        complain('ended; what is finished stays: start again to go on')
    finally:
        client.close(timeout=2)
        if cluster:
            cluster.close(timeout=5)
            if os.path.isdir(arguments.out):
                clear_parts(arguments.out, shards)
    if arguments.merge:
        merge(arguments.merge, arguments.out, shards)


if __name__ == '__main__':
    main()
