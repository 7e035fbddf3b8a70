% Runge-Kutta of order four in fixed steps; an impact ends its step at the root of the gap.
%
%   octave rk4_events.m PROBLEM_DIRECTORY out.csv STEP       (a step in parts of the run)
%
% Newton's law contact by contact. Nothing rests: where impacts accumulate it gives up. Decks in
% plan it does not know.
1;
function a = ground(t, p)   % the formula of the motion, or its samples
  a = 0;
  for i = 1:numel(p.motion)
    m = p.motion{i};
    if t < m.start || t >= m.end, continue, end
    s = t - m.origin;
    if isfield(m, "sinusoids")
      w = reshape(m.sinusoids, [], 3);
      a = sum(w(:, 1) .* cos(w(:, 2) * s + w(:, 3)));
    elseif isfield(m, "gaussian")
      c = m.gaussian;
      a = (c(2) + s * (c(3) + s * (c(4) + s * c(5)))) * exp(-c(1) * s ^ 2);
    else
      k = min(floor(s / m.dt), numel(m.samples) - 2);
      a = m.samples(k + 1) + (m.samples(k + 2) - m.samples(k + 1)) * (s / m.dt - k);
    end
  end
end
function dy = rate(t, y, p)   % y = (u, v, z)
  N = p.N;
  u = y(1:N); v = y(N + 1:2 * N); z = y(2 * N + 1:end);
  s = p.springs;
  x = p.B' * u - s.offset; dx = p.B' * v;
  k = s.extension; k(x < 0) = s.compression(x < 0);
  f = k .* x + s.strength .* z;
  w = abs(z) .^ s.n;
  dz = dx .* (1 - (s.beta + s.gamma .* sign(dx .* z)) .* w) ./ s.yield_displacement;
  dy = [v; -(p.C * v + p.B * f) ./ p.M - ground(t, p); dz];
end
function y = step(t, y, h, p)
  k1 = rate(t, y, p);
  k2 = rate(t + h / 2, y + h / 2 * k1, p);
  k3 = rate(t + h / 2, y + h / 2 * k2, p);
  k4 = rate(t + h * (1 - 1e-12), y + h * k3, p);   % a jump at its end is not yet
  y = y + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
end

[folder, out, size_] = argv(){end - 2:end};
p = jsondecode(fileread([folder "/problem.json"]), "makeValidName", false);
if isfield(p, "iota"), error("knows bodies on a line, no decks in plan"), end
if isstruct(p.motion), p.motion = num2cell(p.motion); end
p.N = N = numel(p.M);
if isempty(p.springs.names)   % empty lists come as cells
  p.B = zeros(N, 0);
  p.springs = structfun(@(x) zeros(0, 1), p.springs, "UniformOutput", false);
end
p.B = reshape(p.B, N, []); p.W = reshape(p.W, N, []); p.C = reshape(p.C, N, N);
hysteretic = find(p.springs.strength != 0);
steps = 40 * ceil(1 / str2double(size_) / 40 - 1e-9);
stride = max(1, fix(steps / 1000));
h = (p.end - p.start) / steps;
y = [p.initial.u; p.initial.v; p.springs.z0];
rows = cell(0, 1);
row = @(t, y) [t; y(1:2 * N); y(2 * N + hysteretic)]';
W = p.W; closing = @(y) p.gaps + W' * y(1:N);
for k = 1:steps
  t = p.start + (k - 1) * h;
  if mod(k - 1, stride) == 0, rows{end + 1} = row(t, y); end
  left = h; impacts = 0;
  while left > 1e-13 * h
    y1 = step(t, y, left, p);
    g = closing(y1);
    hit = find(g < 0 & W' * y1(N + 1:2 * N) < 0);
    if isempty(hit), y = y1; break, end
    low = 0; high = left;   % the first instant at which a gap closes, by bisection
    for i = 1:50
      half = (low + high) / 2;
      y1 = step(t, y, half, p);
      if any(closing(y1)(hit) < 0), high = half; else, low = half; end
    end
    y = step(t, y, low, p); t += low; left -= low;
    rows{end + 1} = row(t, y);
    [~, c] = min(closing(y)(hit)); c = hit(c);
    y(N + 1:2 * N) -= (1 + p.restitutions(c)) * (W(:, c)' * y(N + 1:2 * N)) ...
                      / sum(W(:, c) .^ 2 ./ p.M) * W(:, c) ./ p.M;
    rows{end + 1} = row(t, y);
    if ++impacts > 50
      error("more than 50 impacts in a step at t = %g s", t);
    end
  end
end
rows{end + 1} = row(p.end, y);
f = fopen(out, "w");
fprintf(f, "# problem %s\nt", p.problem);
fprintf(f, ",u.%s", p.bodies{:}); fprintf(f, ",v.%s", p.bodies{:});
if !isempty(hysteretic), fprintf(f, ",z.%s", p.springs.names{hysteretic}); end
fprintf(f, "\n");
form = [repmat("%.17g,", 1, numel(rows{1}) - 1) "%.17g\n"];
fprintf(f, form, vertcat(rows{:})');
fclose(f);
