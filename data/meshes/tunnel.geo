// A lined tunnel and 1 m of its rock. Metres; y along the tunnel, z up, free surface at z = 0.
radius = 5; thickness = 0.5; depth = 30; w = 40; h = 60; length = 1;
Point(1) = {0, 0, -depth};
For i In {0:3}
  a = Pi / 4 + i * Pi / 2; inner = radius; outer = radius + thickness;
  Point(10 + i) = {inner * Cos(a), 0, -depth + inner * Sin(a), 1};
  Point(20 + i) = {outer * Cos(a), 0, -depth + outer * Sin(a), 1};
EndFor
Point(30) = {w, 0, 0, 4}; Point(31) = {-w, 0, 0, 4}; Point(32) = {-w, 0, -h, 4}; Point(33) = {w, 0, -h, 4};
For i In {0:3}
  j = (i + 1) % 4;
  Circle(10 + i) = {10 + i, 1, 10 + j};
  Circle(20 + i) = {20 + i, 1, 20 + j};
  Line(30 + i) = {30 + i, 30 + j};
  Line(40 + i) = {10 + i, 20 + i};
EndFor
For i In {0:3}
  Curve Loop(i + 1) = {10 + i, 40 + (i + 1) % 4, -(20 + i), -(40 + i)};
  Plane Surface(i + 1) = {i + 1};
EndFor
Curve Loop(5) = {30:33}; Curve Loop(6) = {20:23};
Plane Surface(5) = {5, 6};
Transfinite Curve{10:13, 20:23} = 25;   // 24 elements along a quarter of the ring,
Transfinite Curve{40:43} = 5;           // 4 across its thickness: longer ones, or fewer, err in bending
Transfinite Surface{1:4};
Recombine Surface{:};                   // quadrilaterals, so that the extrusion gives bricks
Mesh.Algorithm = 8;
Extrude {0, length, 0} { Surface{:}; Layers{1}; Recombine; }
Physical Volume("lining") = {1:4};
Physical Volume("rock") = {5};
e = 0.01;
Physical Surface("left") = Surface In BoundingBox {-w-e, -e, -h-e, -w+e, length+e, e};
Physical Surface("right") = Surface In BoundingBox {w-e, -e, -h-e, w+e, length+e, e};
Physical Surface("front") = Surface In BoundingBox {-w-e, -e, -h-e, w+e, e, e};
Physical Surface("back") = Surface In BoundingBox {-w-e, length-e, -h-e, w+e, length+e, e};
Physical Surface("bottom") = Surface In BoundingBox {-w-e, -e, -h-e, w+e, length+e, -h+e};
