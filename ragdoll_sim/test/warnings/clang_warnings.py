#!/usr/bin/env python3
"""Compiles the packages' own sources with clang++, which warns of what gcc does not, without
writing anything. A warning fails the test.

clang_warnings.py COMPILE_COMMANDS RESULT.xml FOLDER...: sources below these folders. What a source
and all headers were when it last passed is kept beside COMPILE_COMMANDS, so that only what changed
is compiled again. Without clang++ the test is skipped and says so.
"""
import concurrent.futures
import hashlib
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from xml.sax.saxutils import escape

WARNINGS = ['-Wall', '-Wextra', '-Wunused-const-variable', '-Wshadow-field', '-Wshadow']
SKIPPED = 77
JOBS = 2
AT_ONCE = 60  # sources: what they instantiate of Eigen once
KEPT = ('-D', '-U', '-I', '-std=', '-ffp-contract', '-fPIC')  # of the options that gcc is given
WITH_VALUE = ('-isystem', '-include', '-I', '-D')


def is_common(header):
    """Of a target: what most of its sources include (CMake's target_precompile_headers)."""
    return os.path.basename(header) == 'cmake_pch.hxx'


def words_of(entry):
    return entry.get('arguments') or shlex.split(entry['command'])


def options_of(entry):
    """Those of gcc's that clang takes, too."""
    words = words_of(entry)
    options = []
    for i, word in enumerate(words):
        if word in WITH_VALUE:
            if not is_common(words[i + 1]):
                options += [word, words[i + 1]]
        elif word.startswith(KEPT) and word not in WITH_VALUE:
            options.append(word)
    return options


def command_of(entry, source, precompiled=None):
    with_common = ['-include-pch', precompiled] if precompiled and os.path.exists(precompiled) else []
    return ['clang++', '-fsyntax-only', *options_of(entry), *with_common, *WARNINGS, source]


def precompiled_path(entry, folder):
    """Where its target's common headers are, or go, compiled; empty: it has none."""
    header = next(filter(is_common, words_of(entry)), None)
    key = ' '.join([header or '', *options_of(entry)])
    return header and os.path.join(folder, hashlib.sha256(key.encode()).hexdigest())


def precompile(entry, folder):
    """The common headers take clang half of its time or more."""
    header = next(filter(is_common, words_of(entry)))
    subprocess.run(['clang++', '-x', 'c++-header', '-fpch-instantiate-templates', *options_of(entry), header, '-o',
                    precompiled_path(entry, folder)],
                   cwd=entry['directory'], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def source_of(entry):
    return os.path.realpath(os.path.join(entry['directory'], entry['file']))


def is_of_several(entry):
    """Whether a unity build has put it together."""
    return os.path.basename(source_of(entry)).startswith('unity_')


def sources_of(entry):
    """Those that are put together in it, or the entry's own."""
    source = source_of(entry)
    if not is_of_several(entry):
        return [source]
    return [os.path.realpath(included)
            for included in re.findall('^#include "(.+)"', open(source).read(), re.MULTILINE)]


def joins(unit, entry, own):
    """Whether the sources of an entry go with those of a unit: a unity build of one target."""
    target = os.path.dirname(source_of(entry))
    return (is_of_several(entry) and is_of_several(unit[0]) and len(unit[1]) + len(own) <= AT_ONCE
            and os.path.dirname(source_of(unit[0])) == target)


def units_below(commands, folders):
    """[(entry, sources below the folders)], with entries that a unity build has made of one target
    in one; what is compiled for several targets once."""
    roots = tuple(os.path.realpath(folder) + os.sep for folder in folders)
    units, seen = [], set()
    for entry in json.load(open(commands)):
        own = [source for source in sources_of(entry) if source.startswith(roots) and source not in seen]
        seen.update(own)
        if own and units and joins(units[-1], entry, own):
            units[-1][1].extend(own)
        elif own:
            units.append((entry, own))
    return units


def joined(sources):
    """The text of all of them. Pasted, not included: clang looks for what is unused only in the file
    that it is given."""
    text = ''
    for source in sources:
        beside = os.path.dirname(source)
        lines = re.sub(r'^#include "([^"]+)"', lambda match: '#include "%s"' % (
            os.path.join(beside, match[1]) if os.path.exists(os.path.join(beside, match[1])) else match[1]),
                       open(source).read(), flags=re.MULTILINE)
        text += '#line 1 "%s"\n%s\n' % (source, lines)
    return text


def digest_of_headers(folders):
    """Of all headers of the packages: a change of one compiles everything again."""
    digest = hashlib.sha256(subprocess.check_output(['clang++', '--version']))
    for folder in folders:
        for path, names, files in sorted(os.walk(os.path.dirname(os.path.realpath(folder)))):
            names[:] = [name for name in names if not name.startswith(('build', '.'))]
            for file in sorted(files):
                if file.endswith('.h'):
                    digest.update(open(os.path.join(path, file), 'rb').read())
    return digest.digest()


def compile_unit(unit, folder):
    """What clang++ says of its sources; empty: nothing."""
    entry, sources = unit
    path = sources[0]
    if len(sources) > 1:
        path = os.path.join(folder, hashlib.sha256(path.encode()).hexdigest() + '.cpp')
        open(path, 'w').write(joined(sources))
    run = subprocess.run(command_of(entry, path, precompiled_path(entry, folder)), cwd=entry['directory'],
                         stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
    return run.stdout or ('' if run.returncode == 0 else 'failed without a word')


def compile_changed(units, headers, passed_path):
    """(sources compiled, what clang++ says of those that it has something to say of)."""
    passed = set(open(passed_path).read().split()) if os.path.exists(passed_path) else set()
    keys = {}
    for entry, sources in units:
        for source in sources:
            text = headers + ' '.join(command_of(entry, source)).encode() + open(source, 'rb').read()
            keys[source] = hashlib.sha256(text).hexdigest()
    changed = [(entry, [source for source in sources if keys[source] not in passed])
               for entry, sources in units]
    changed = [unit for unit in changed if unit[1]]
    with concurrent.futures.ThreadPoolExecutor(JOBS) as pool, tempfile.TemporaryDirectory() as folder:
        folders = [folder] * len(changed)
        common = {precompiled_path(entry, folder): entry for entry, _ in changed}
        common.pop(None, None)
        list(pool.map(precompile, common.values(), folders))
        said = list(pool.map(compile_unit, changed, folders))
    warned = {source for (_, sources), text in zip(changed, said) if text for source in sources}
    with open(passed_path, 'w') as out:
        out.write('\n'.join(key for source, key in sorted(keys.items()) if source not in warned))
    return sum(len(sources) for _, sources in changed), [text for text in said if text]


def write_result(path, inner):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, 'w') as out:
        out.write('<testsuite name="clang_warnings"><testcase classname="ClangWarnings" '
                  'name="None">%s</testcase></testsuite>\n' % inner)


def main(commands, result, *folders):
    os.nice(19)
    if not shutil.which('clang++'):
        print('skipped: clang++ is not installed (Debian, Ubuntu: clang)')
        write_result(result, '<skipped/>')
        return SKIPPED
    units = units_below(commands, folders)
    if not units:
        print('no sources below ' + ' '.join(folders))
        return 1
    passed = os.path.join(os.path.dirname(os.path.abspath(commands)), 'clang_warnings_passed.txt')
    compiled, said = compile_changed(units, digest_of_headers(folders), passed)
    text = ''.join(said)
    print(text + '%d sources, %d compiled, %d texts of warnings' % (
        sum(len(sources) for _, sources in units), compiled, len(said)))
    write_result(result, '<failure>%s</failure>' % escape(text) if said else '')
    return 1 if said else 0


if __name__ == '__main__':
    sys.exit(main(*sys.argv[1:]))
