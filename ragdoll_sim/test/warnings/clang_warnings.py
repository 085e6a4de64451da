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


def command_of(entry, precompiled=()):
    return ['clang++', '-fsyntax-only', *options_of(entry), *precompiled, *WARNINGS, source_of(entry)]


def precompile(entry, folder):
    """What adds its target's common headers, compiled, to clang's command; nothing where that fails.
    They take clang half of its time or more."""
    header = next(filter(is_common, words_of(entry)), None)
    if not header:
        return []
    key = ' '.join([header, *options_of(entry)])
    path = os.path.join(folder, hashlib.sha256(key.encode()).hexdigest())
    if not os.path.exists(path):
        subprocess.run(['clang++', '-x', 'c++-header', *options_of(entry), header, '-o', path],
                       cwd=entry['directory'], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return ['-include-pch', path] if os.path.exists(path) else []


def source_of(entry):
    return os.path.realpath(os.path.join(entry['directory'], entry['file']))


def own_entries(entry):
    """An entry for each source that a unity build has put together in one, or the entry itself."""
    if not os.path.basename(entry['file']).startswith('unity_'):
        return [entry]
    sources = re.findall('^#include "(.+)"', open(source_of(entry)).read(), re.MULTILINE)
    return [dict(entry, file=source) for source in sources]


def entries_below(commands, folders):
    roots = tuple(os.path.realpath(folder) + os.sep for folder in folders)
    found = {source_of(own): own for entry in json.load(open(commands)) for own in own_entries(entry)
             if source_of(own).startswith(roots)}
    return [found[source] for source in sorted(found)]


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


def compile_one(entry, precompiled):
    """What clang++ says; empty: nothing."""
    run = subprocess.run(command_of(entry, precompiled), cwd=entry['directory'], stdout=subprocess.PIPE,
                         stderr=subprocess.STDOUT, universal_newlines=True)
    return run.stdout or ('' if run.returncode == 0 else 'failed without a word')


def compile_changed(entries, headers, passed_path):
    """(sources compiled, what clang++ says of those that it has something to say of)."""
    passed = set(open(passed_path).read().split()) if os.path.exists(passed_path) else set()
    keys = {}
    for entry in entries:
        text = headers + ' '.join(command_of(entry)).encode() + open(source_of(entry), 'rb').read()
        keys[source_of(entry)] = hashlib.sha256(text).hexdigest()
    changed = [entry for entry in entries if keys[source_of(entry)] not in passed]
    with concurrent.futures.ThreadPoolExecutor(JOBS) as pool, tempfile.TemporaryDirectory() as folder:
        precompiled = [precompile(entry, folder) for entry in changed]
        said = dict(zip(map(source_of, changed), pool.map(compile_one, changed, precompiled)))
    with open(passed_path, 'w') as out:
        out.write('\n'.join(key for source, key in sorted(keys.items()) if not said.get(source)))
    return len(changed), [text for text in said.values() if text]


def write_result(path, inner):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, 'w') as out:
        out.write('<testsuite name="clang_warnings"><testcase classname="ClangWarnings" '
                  'name="None">%s</testcase></testsuite>\n' % inner)


def main(commands, result, *folders):
    if not shutil.which('clang++'):
        print('skipped: clang++ is not installed (Debian, Ubuntu: clang)')
        write_result(result, '<skipped/>')
        return SKIPPED
    entries = entries_below(commands, folders)
    if not entries:
        print('no sources below ' + ' '.join(folders))
        return 1
    passed = os.path.join(os.path.dirname(os.path.abspath(commands)), 'clang_warnings_passed.txt')
    compiled, said = compile_changed(entries, digest_of_headers(folders), passed)
    text = ''.join(said)
    print(text + '%d sources, %d compiled, %d with warnings' % (len(entries), compiled, len(said)))
    write_result(result, '<failure>%s</failure>' % escape(text) if said else '')
    return 1 if said else 0


if __name__ == '__main__':
    sys.exit(main(*sys.argv[1:]))
