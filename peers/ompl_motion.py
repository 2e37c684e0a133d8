#!/usr/bin/env python3
"""OMPL's RRTConnect and PathSimplifier on motion problems, with a NumPy checker of spheres: a peer of `clearway bench motion`.

    pip install ompl numpy
    ompl_motion.py --robot URDF --srdf SRDF --problems FILE [N] [--mode batch|state] [--sets a,b] [--seed 1] [--limit 10] [--out FILE]

N         problems per set (default 3; 0 = all), as in the file, invalid ones left out
--mode    state (default): OMPL's own discrete motion validator calling the checker one state at a time
          batch: a MotionValidator in Python that checks a motion's states in NumPy batches of 16
Both look at 32 states per radian of joint-space distance, range 1.0.  The URDF's shapes have to be spheres, its joints a
serial chain.  Cylinders count as VAMP's scripts take them.  States checked are counted per solve; times are the wall's, the
checker's share in them is told, since most of it is Python's.
"""
import os
for _v in ('OMP_NUM_THREADS', 'OPENBLAS_NUM_THREADS', 'MKL_NUM_THREADS'):
    os.environ[_v] = '1'
import argparse, json, math, statistics, time
import xml.etree.ElementTree as ET
import numpy as np

CHECKS_PER_RAD = 32.0


# ---------------------------------------------------------------- robot
def _floats(text):
    return np.array([float(x) for x in text.split()])


def _rpy(r, p, y):
    cr, sr, cp, sp, cy, sy = math.cos(r), math.sin(r), math.cos(p), math.sin(p), math.cos(y), math.sin(y)
    return np.array([[cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
                     [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
                     [-sp, cp * sr, cp * cr]])


def _origin(el):
    T = np.eye(4)
    o = el.find('origin') if el is not None else None
    if o is not None:
        T[:3, :3] = _rpy(*_floats(o.get('rpy', '0 0 0')))
        T[:3, 3] = _floats(o.get('xyz', '0 0 0'))
    return T


class Robot:
    """A serial arm of revolute joints; the spheres of links behind fixed joints ride on the frame that carries them."""

    def __init__(self, urdf, srdf):
        root = ET.parse(urdf).getroot()
        links = {l.get('name'): l for l in root.findall('link')}
        joints = root.findall('joint')
        children = {}
        for j in joints:
            children.setdefault(j.find('parent').get('link'), []).append(j)
        base = (set(links) - {j.find('child').get('link') for j in joints}).pop()
        self.names, self.lower, self.upper = [], [], []
        self.pre = []                    # fixed transform from the previous frame to each moving frame
        spheres = []                     # (frame, link, centre in frame, radius); frame 0 = the base
        skip = set()

        def walk(link, frame, T):
            for c in links[link].findall('collision'):
                s = c.find('geometry').find('sphere')
                if s is None:
                    raise ValueError('collision geometry of %s is not a sphere' % link)
                spheres.append((frame, link, (T @ _origin(c))[:3, 3], float(s.get('radius'))))
            for j in children.get(link, []):
                child = j.find('child').get('link')
                skip.add(frozenset((link, child)))
                Tj = T @ _origin(j)
                if j.get('type') == 'fixed':
                    walk(child, frame, Tj)
                    continue
                if j.get('type') != 'revolute' or not np.array_equal(_floats(j.find('axis').get('xyz')), [0, 0, 1]) \
                        or frame != len(self.names):
                    raise ValueError('only a serial chain of revolute joints about z is known here: ' + j.get('name'))
                self.names.append(j.get('name'))
                self.lower.append(float(j.find('limit').get('lower')))
                self.upper.append(float(j.find('limit').get('upper')))
                self.pre.append(Tj)
                walk(child, frame + 1, np.eye(4))

        walk(base, 0, np.eye(4))
        for d in ET.parse(srdf).getroot().findall('disable_collisions'):
            skip.add(frozenset((d.get('link1'), d.get('link2'))))
        self.dof = len(self.names)
        spheres.sort(key=lambda s: s[0])
        self.radius = np.array([s[3] for s in spheres])
        self.n = len(spheres)
        self.by_frame = []
        for f in range(self.dof + 1):
            idx = [i for i, s in enumerate(spheres) if s[0] == f]
            if idx:
                self.by_frame.append((f, slice(idx[0], idx[-1] + 1), np.array([spheres[i][2] for i in idx]).T))
        pairs = [(a, b) for a in range(self.n) for b in range(a) if spheres[a][1] != spheres[b][1]
                 and spheres[a][0] != spheres[b][0] and frozenset((spheres[a][1], spheres[b][1])) not in skip]
        self.pa, self.pb = np.array(pairs).T
        self.pr2 = (self.radius[self.pa] + self.radius[self.pb]) ** 2
        self.link_pairs = sorted({tuple(sorted((spheres[a][1], spheres[b][1]))) for a, b in pairs})
        self.preR = [T[:3, :3] for T in self.pre]
        self.pret = [T[:3, 3] for T in self.pre]

    def fk(self, q):
        """q (N, dof) -> sphere centres (N, n, 3)"""
        n = len(q)
        out = np.empty((n, self.n, 3))
        c, s = np.cos(q), np.sin(q)
        R = np.broadcast_to(np.eye(3), (n, 3, 3))
        t = np.zeros((n, 3))
        frames = {f: (sl, P) for f, sl, P in self.by_frame}
        for f in range(self.dof + 1):
            if f:
                t = t + R @ self.pret[f - 1]
                A = R @ self.preR[f - 1]
                cj, sj = c[:, f - 1, None], s[:, f - 1, None]
                R = np.empty((n, 3, 3))
                R[:, :, 0] = A[:, :, 0] * cj + A[:, :, 1] * sj
                R[:, :, 1] = A[:, :, 1] * cj - A[:, :, 0] * sj
                R[:, :, 2] = A[:, :, 2]
            if f in frames:
                sl, P = frames[f]
                out[:, sl] = np.swapaxes(R @ P, 1, 2) + t[:, None, :]
        return out


# ---------------------------------------------------------------- world
class World:
    def __init__(self, problem, set_name):
        bc, bR, bh, self.caps, self.balls = [], [], [], [], []
        for o in problem['box']:
            bc.append(o['position']); bR.append(self.rot(o)); bh.append(o['half_extents'])
        for o in problem['cylinder']:
            R, r, l = self.rot(o), o['radius'], o['length']
            if set_name == 'box':        # as VAMP's problem_dict_to_vamp: cuboids in this set, capsules elsewhere
                bc.append(o['position']); bR.append(R); bh.append([r, r, l / 2])
            else:
                c = np.array(o['position'])
                self.caps.append((c - R[:, 2] * l / 2, R[:, 2] * l, r))
        for o in problem['sphere']:
            self.balls.append((np.array(o['position']), o['radius']))
        self.bc, self.bh = np.array(bc).reshape(-1, 3), np.array(bh).reshape(-1, 3)
        self.bR = np.array(bR).reshape(-1, 3, 3)
        # one product gives every sphere in every box's frame: (.., 3) @ (3, 3B) - offsets
        self.M = self.bR.transpose(1, 0, 2).reshape(3, -1)
        self.off = np.einsum('bi,bij->bj', self.bc, self.bR).reshape(-1)
        self.half = self.bh.reshape(-1)
        if self.caps:
            self.ca = np.array([c[0] for c in self.caps]); self.cv = np.array([c[1] for c in self.caps])
            self.cr = np.array([c[2] for c in self.caps]); self.cd = 1.0 / (self.cv ** 2).sum(1)

    @staticmethod
    def rot(o):
        return _rpy(*o['orientation_euler_xyz'])

    def hits(self, X, r):
        """X (N, S, 3), r (S,) -> (N,) bool"""
        bad = np.zeros(len(X), bool)
        if len(self.bc):
            d = np.abs(X @ self.M - self.off) - self.half
            np.maximum(d, 0, out=d)
            d *= d
            d = d.reshape(X.shape[:2] + (-1, 3)).sum(-1).min(-1)
            bad |= (d < r * r).any(1)
        if self.caps:
            rel = X[:, :, None, :] - self.ca
            u = np.clip((rel * self.cv).sum(-1) * self.cd, 0, 1)
            rel = rel - u[..., None] * self.cv
            bad |= ((rel * rel).sum(-1) < (r[:, None] + self.cr) ** 2).any((1, 2))
        for c, br in self.balls:
            bad |= (((X - c) ** 2).sum(-1) < (r + br) ** 2).any(1)
        return bad


class Checker:
    def __init__(self, robot, world):
        self.robot, self.world = robot, world
        self.states = self.calls = 0
        self.seconds = 0.0

    def valid(self, q):
        t0 = time.perf_counter()
        rb = self.robot
        X = rb.fk(q)
        bad = self.world.hits(X, rb.radius)
        d = X[:, rb.pa] - X[:, rb.pb]
        bad |= ((d * d).sum(-1) < rb.pr2).any(1)
        self.states += len(q)
        self.calls += 1
        self.seconds += time.perf_counter() - t0
        return ~bad

    def motion(self, a, b, chunk=16):
        """the far end, then the interior, coarse to fine, in batches; stops after the first batch with a bad state"""
        n = max(1, math.ceil(float(np.linalg.norm(b - a)) * CHECKS_PER_RAD))
        k = np.arange(n, 0, -1)
        stride = max(1, math.ceil(n / chunk))
        order = np.concatenate([k[i::stride] for i in range(stride)])
        d = (b - a) / n
        for i in range(0, n, chunk):
            if not self.valid(a + order[i:i + chunk, None] * d).all():
                return False
        return True


# ---------------------------------------------------------------- OMPL
def solve(robot, problem, set_name, args):
    from ompl import base as ob, geometric as og
    dof = robot.dof
    space = ob.RealVectorStateSpace(dof)
    bounds = ob.RealVectorBounds(dof)
    start, goals = np.array(problem['start']), [np.array(g) for g in problem['goals']]
    ends = np.array([start] + goals)
    for i in range(dof):                 # a start or goal on the limit must not be lost to rounding
        bounds.setLow(i, float(min(robot.lower[i], ends[:, i].min())))
        bounds.setHigh(i, float(max(robot.upper[i], ends[:, i].max())))
    space.setBounds(bounds)
    si = ob.SpaceInformation(space)
    ck = Checker(robot, World(problem, set_name))

    def state_valid(s):
        return bool(ck.valid(np.array([s[0:dof]]))[0])

    si.setStateValidityChecker(state_valid)
    si.setStateValidityCheckingResolution(1.0 / CHECKS_PER_RAD / space.getMaximumExtent())
    if args.mode == 'batch':
        class Motion(ob.MotionValidator):
            def __init__(self, si):
                super().__init__(si)

            def checkMotion(self, a, b, *rest):
                return ck.motion(np.array(a[0:dof]), np.array(b[0:dof]))
        mv = Motion(si)
        si.setMotionValidator(mv)
    si.setup()
    pdef = ob.ProblemDefinition(si)

    def state(q):
        s = si.allocState()
        s[0:dof] = [float(x) for x in q]
        return s
    pdef.addStartState(state(start))
    goal = ob.GoalStates(si)
    for g in goals:
        goal.addState(state(g))
    pdef.setGoal(goal)
    planner = og.RRTConnect(si)
    planner.setRange(1.0)
    planner.setProblemDefinition(pdef)
    planner.setup()
    row = {'valid': True, 'solved': False}
    t0 = time.perf_counter()
    planner.solve(ob.timedPlannerTerminationCondition(args.limit))
    t1 = time.perf_counter()
    row['states_plan'], row['plan_checker_us'] = ck.states, round(ck.seconds * 1e6, 1)
    row['calls_plan'] = ck.calls
    row['plan_us'] = round((t1 - t0) * 1e6, 1)
    if not pdef.hasExactSolution():
        return row
    path = pdef.getSolutionPath()
    n0, c0, s0 = ck.states, path.length(), ck.seconds
    row['solved'] = True
    t2 = time.perf_counter()
    simplifier = og.PathSimplifier(si)
    simplifier.simplify(path, max(1.0, args.limit - (t1 - t0)))
    t3 = time.perf_counter()
    row.update(simplify_us=round((t3 - t2) * 1e6, 1), initial_cost=round(c0, 4), cost=round(path.length(), 4),
               states_simplify=ck.states - n0, simplify_checker_us=round((ck.seconds - s0) * 1e6, 1))
    Q = [np.array(s[0:dof]) for s in path.getStates()]
    row['points'] = len(Q)
    judge = Checker(robot, ck.world)     # the answer, looked at once more with a checker of its own
    row['path_ok'] = bool(judge.valid(np.array(Q)).all() and all(judge.motion(a, b) for a, b in zip(Q, Q[1:]))
                          and np.allclose(Q[0], start, atol=1e-9) and min(np.abs(Q[-1] - g).max() for g in goals) < 1e-9)
    return row


def main():
    ap = argparse.ArgumentParser()
    ap.add_argument('n', nargs='?', type=int, default=3)
    for file in ('--robot', '--srdf', '--problems'):
        ap.add_argument(file, required=True)
    ap.add_argument('--mode', choices=('batch', 'state'), default='state')
    ap.add_argument('--sets')
    ap.add_argument('--seed', type=int, default=1)
    ap.add_argument('--limit', type=float, default=10.0)
    ap.add_argument('--out')
    args = ap.parse_args()
    from ompl import util as ou
    ou.setLogLevel(ou.LogLevel.LOG_ERROR)
    ou.RNG.setSeed(args.seed)
    robot = Robot(args.robot, args.srdf)
    data = json.load(open(args.problems))
    if data['joints'] != robot.names:
        ap.error('%s has the joints %s, the problems are for %s' % (args.robot, robot.names, data['joints']))
    rows = []
    for name, ps in data['problems'].items():
        if args.sets and name not in args.sets.split(','):
            continue
        ps = [p for p in ps if p['valid']]
        for p in ps[:args.n] if args.n else ps:
            row = dict({'set': name, 'index': p['index']}, **solve(robot, p, name, args))
            rows.append(row)
            print('%-18s %3d %s' % (name, p['index'], 'plan %8.1f ms (%6d states)  simplify %8.1f ms (%6d states)  cost %.3f -> %.3f  %s' % (
                row['plan_us'] / 1e3, row['states_plan'], row['simplify_us'] / 1e3, row['states_simplify'], row['initial_cost'],
                row['cost'], 'ok' if row['path_ok'] else 'PATH NOT VALID') if row['solved'] else
                'NOT SOLVED in %.1f s (%d states)' % (row['plan_us'] / 1e6, row['states_plan'])), flush=True)
    s = [r for r in rows if r['solved']]
    print('solved %d of %d, paths valid %d' % (len(s), len(rows), sum(r['path_ok'] for r in s)))
    for k in ('plan_us', 'simplify_us', 'states_plan', 'states_simplify', 'initial_cost', 'cost'):
        v = sorted(r[k] for r in s)
        print('  %-16s median %10.2f  mean %10.2f  p95 %10.2f' % (k, statistics.median(v), statistics.mean(v), np.percentile(v, 95)))
    if s:
        print('  per state checked %.1f us; share of planning time outside the checker %.1f %% (with the bindings)' % (
            sum(r['plan_checker_us'] + r['simplify_checker_us'] for r in s) / sum(r['states_plan'] + r['states_simplify'] for r in s),
            100 * (1 - sum(r['plan_checker_us'] for r in s) / sum(r['plan_us'] for r in s))))
    if args.out:
        import importlib.metadata as im
        json.dump({'what': 'OMPL %s (PyPI), RRTConnect + PathSimplifier, Python/NumPy checker (%s), one thread, seed %d, limit %g s'
                   % (im.version('ompl'), args.mode, args.seed, args.limit), 'robot': data['robot'], 'spheres': robot.n, 'range': 1.0,
                   'checks_per_rad': CHECKS_PER_RAD, 'rows': rows}, open(args.out, 'w'))


if __name__ == '__main__':
    main()
