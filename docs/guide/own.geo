// A bank of sand, 6 m high at 1V:2H, on 4 m of clay: gmsh -2 own.geo -o own.msh
SetFactory("Built-in");
h = 1.5;
Point(1) = {0, 0, 0, h};   Point(2) = {40, 0, 0, h};  Point(3) = {40, 4, 0, h};
Point(4) = {26, 4, 0, 0.7}; Point(5) = {14, 10, 0, 1}; Point(6) = {0, 10, 0, h};
Point(7) = {0, 4, 0, h};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 5};
Line(5) = {5, 6}; Line(6) = {6, 7}; Line(7) = {7, 1}; Line(8) = {4, 7};
Curve Loop(1) = {1, 2, 3, 8, 7};  Plane Surface(1) = {1};
Curve Loop(2) = {4, 5, 6, -8};    Plane Surface(2) = {2};
Physical Surface("clay") = {1};
Physical Surface("sand") = {2};
Physical Curve("base") = {1};
Physical Curve("sides") = {2, 6, 7};
Physical Curve("crest") = {5};
