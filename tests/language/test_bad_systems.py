"""Invalid system.xml files: each gives the expected line and message, and no output."""

import re
import resource
import signal
import subprocess

import pytest

from fmu import LAGC, ROOT, lagc

# A valid system; the cases below replace or add lines (counted from 1).
RIGHT = """\
<system name="Broken" description="Pendulum">
  <parameter name="m" start="1" unit="kg" min="0"/>
  <parameter name="l" start="1" unit="m" min="0"/>
  <parameter name="g" start="9.81" unit="m/s2"/>
  <input name="tau" unit="N.m"/>
  <coordinate name="theta" velocity="omega" unit="rad" start="1"/>
  <particle name="bob" mass="m" x="l*sin(theta)" y="-l*cos(theta)"/>
  <potential>m*g*bob.y</potential>
  <force coordinate="theta">tau</force>
  <output name="height" unit="m">bob.y</output>
  <solver method="erk" tolerance="1e-8"/>
  <experiment stopTime="10" stepSize="0.01"/>
</system>
"""

# Kind of mistake, the replaced line, its new text (possibly several lines), the expected line and message.
CASES = [
    ("not XML", 7, "<particle <", 7, "'<' begins an element"),
    ("tag not closed", 8, "<potential>m*g*l", 13, "</system> stands where <potential> of line 8 is still open"),
    ("unknown element", 8, "<potentail>m*g*bob.y</potentail>", 8, "<potentail> is not an element of <system>; did you mean 'potential'"),
    ("unknown attribute", 6, '<coordinate name="theta" speed="omega" unit="rad"/>', 6,
     "<coordinate> has no attribute 'speed'; expected name, unit, displayUnit, description, start, nominal, velocity, "),
    ("velocity missing", 6, '<coordinate name="theta" unit="rad"/>', 6, "<coordinate> needs the attribute 'velocity'"),
    ("parameter without start", 2, '<parameter name="m" unit="kg"/>', 2, "<parameter> needs the attribute 'start'"),
    ("name with a space", 2, '<parameter name="m 1" start="1"/>', 2, 'name="m 1" of <parameter> is not a name; expected letters'),
    ("unknown solver", 11, '<solver method="euler"/>', 11, 'method="euler" of <solver> is not known; expected taylor, erk'),
    ("negative tolerance", 11, '<solver method="erk" tolerance="-1"/>', 11, 'tolerance="-1" of <solver> is not above 0'),
    ("tolerance of 5", 11, '<solver method="erk" tolerance="5"/>', 11, "tolerance is 5; expected a number between 0 and 1"),
    ("tolerance by a constant", 11, '<constant name="INF" value="-1"/><solver method="erk" tolerance="INF"/>', 11,
     "tolerance is -1; expected"),
    ("step by a constant", 12, '<constant name="INF" value="0"/><experiment stepSize="INF"/>', 12, "stepSize is 0; expected"),
    ("largest step of zero", 11, '<solver method="erk" maxStep="0"/>', 11, 'maxStep="0" of <solver> is not above 0'),
    ("largest step of the exact method", 11, '<solver method="exact" maxStep="0.1"/>', 11, "expected no maxStep"),
    ("half a step at most", 11, '<solver method="erk" maxSteps="0.5"/>', 11, "maxSteps is 0.5; expected a whole number from 1 to 1e9"),
    ("number of steps of the exact method", 11, '<solver method="exact" maxSteps="10"/>', 11, "expected no maxSteps"),
    ("step of zero", 12, '<experiment stepSize="0"/>', 12, 'stepSize="0" of <experiment> is not above 0'),
    ("stop before start", 12, '<experiment startTime="5" stopTime="2"/>', 12, "stopTime 2 is not after startTime 5"),
    ("second solver", 12, '<solver method="bdf"/>', 12, "second <solver>"),
    ("second experiment", 11, '<experiment stopTime="3"/>', 12, "second <experiment>"),
    ("unknown name", 8, "<potential>m*G*bob.y</potential>", 8, "unknown name 'G'; did you mean 'g'"),
    ("unknown name far from others", 8, "<potential>m*gravity*l</potential>", 8, "unknown name 'gravity'; expected"),
    ("unknown particle", 8, "<potential>m*g*bab.y</potential>", 8, r"'bab\.y'; did you mean 'bob\.y'"),
    ("name in upper case", 8, "<potential>M*g*bob.y</potential>", 8, "unknown name 'M'; did you mean 'm'"),
    ("name with exchanged letters", 8, "<potential>m*g*l*theat</potential>", 8, "unknown name 'theat'; did you mean 'theta'"),
    ("name without a letter", 8, '<define name="velocity">l*omega</define><potential>m*velocty^2</potential>', 8,
     "unknown name 'velocty'; did you mean 'velocity'"),
    ("single letter", 8, "<potential>m*g*k*bob.y</potential>", 8, "unknown name 'k'; expected a parameter"),
    ("two letters", 8, "<potential>m*g*ll</potential>", 8, "unknown name 'll'; expected a parameter"),
    ("name like that of a function", 8, "<potential>m*g*cas</potential>", 8, "unknown name 'cas'; expected a parameter"),
    ("function with a letter too many", 8, "<potential>m*g*l*sinn(theta)</potential>", 8, "unknown function 'sinn'; did you mean 'sin'"),
    ("function in upper case", 8, "<potential>m*g*l*Cos(theta)</potential>", 8, "unknown function 'Cos'; did you mean 'cos'"),
    ("root with a wrong letter", 8, "<potential>m*g*l*sqtr(theta)</potential>", 8, "unknown function 'sqtr'; did you mean 'sqrt'"),
    ("function like a name", 8, "<potential>m*g*l*thetta(2)</potential>", 8, "unknown function 'thetta'; expected sin"),
    ("unknown function", 8, "<potential>m*g*l*besselj(theta)</potential>", 8, "unknown function 'besselj'; expected sin"),
    ("function in full", 8, "<potential>m*g*l*cosine(theta)</potential>", 8, "unknown function 'cosine'; did you mean 'cos'"),
    ("function without argument", 8, "<potential>m*g*l*cos</potential>", 8, "'cos' is not a variable"),
    ("parenthesis not closed", 8, "<potential>m*g*(l - bob.y</potential>", 8, r"expected '\)' to close.*the end"),
    ("parenthesis not opened", 8, "<potential>m*g*l)</potential>", 8, r"'\)' without '\('"),
    ("two operators", 8, "<potential>m*/g</potential>", 8, "expected a number, a name or.*found '/'"),
    ("missing operator", 8, "<potential>m g</potential>", 8, "expected an operator or the end, found 'g'"),
    ("product without *", 8, "<potential>2m*g*l</potential>", 8, r"'2m\*g\*l' is not a number.*write \* for a product"),
    ("hexadecimal number", 8, "<potential>0x10*m*g*l</potential>", 8, "'0x' is not a number"),
    ("number too large", 8, "<potential>1e999*m*g*l</potential>", 8, "'1e999' is too large for a number; expected one below 1e308"),
    ("division by zero", 8, "<potential>m*g*l/0</potential>", 8, "division by zero"),
    ("root of a negative number", 8, "<potential>\n sqrt(-1)*m*g*l</potential>", 9, r"sqrt\(-1\) is not a real number"),
    ("logarithm of 0", 8, "<potential>log(0)*m*g*l</potential>", 8, r"log\(0\) has no finite value; expected .* positive"),
    ("arc sine of 2", 8, "<potential>asin(2)*m*g*l</potential>", 8, r"asin\(2\) has no finite value; expected .* from -1 to 1"),
    ("exponential of 1000", 8, "<potential>exp(1000)*m*g*l</potential>", 8, r"exp\(1000\) has no finite value"),
    ("tangent at its pole", 8, "<potential>tan(pi/2)*m*g*l</potential>", 8, "has no finite value; expected .* poles"),
    ("power of 0", 8, "<potential>0^-1*m*g*l</potential>", 8, r"\(0\)\^\(-1\) has no finite value"),
    ("broken power of a negative number", 8, "<potential>(-8)^(1/3)*m*g*l</potential>", 8, r"\(-8\)\^\(0.333333\) has no finite"),
    ("varying power of a negative number", 8, "<potential>(-2)^theta*m*g*l</potential>", 8, "the base of a power is -2, and its exponent varies"),
    ("product that is too large", 8, "<potential>1e308*10*m*g*l</potential>", 8, "a product of numbers is not finite"),
    ("sum that is too large", 8, "<potential>1e308*m*g*l + 1e308*m*g*l</potential>", 8, "a sum of numbers is not finite"),
    ("sum of terms that is too large", 8, "<potential>m*g*l*sum(i, 1, 3, 1e308)</potential>", 8, "a sum of numbers is not finite"),
    ("power that is too large", 8, "<potential>m*g*l*(1e200*theta)^2</potential>", 8, "a power of numbers is not finite"),
    ("derivative that is too large", 8, "<potential>1e308*m*g*l*theta^3</potential>", 6, r"equation of der\(omega\) .* not finite"),
    ("start that is not a real number", 2, '<parameter name="m" start="sqrt(-1)"/>', 2, r"start: sqrt\(-1\) is not a real"),
    ("empty expression", 8, "<potential> </potential>", 8, "expected a number, a name or '\\(', found the end"),
    ("missing argument", 8, "<potential>m*g*l*atan2(theta)</potential>", 8, "expected ',' between the two arguments"),
    ("argument too many", 8, "<potential>m*g*l*cos(theta, 1)</potential>", 8, r"expected '\)' after the argument of cos"),
    ("strange character", 8, "<potential>m*g*l#2</potential>", 8, "found '#'"),
    ("letter of another alphabet", 8, "<potential>m*g*l*cos(θ)</potential>", 8, "found 'θ'"),
    ("units of a sum", 8, "<potential>m*g*(l + m)</potential>", 8, "unit mismatch: m and kg in one sum"),
    ("unit of a function", 8, "<potential>m*g*(l + cos(theta))</potential>", 8, "m and 1 in one sum; .*; multiply terms of the unit 1 by a <constant>"),
    ("unit that no number mends", 8, "<potential>m*g*l + m*omega</potential>", 8, r"kg.m2/s2 and kg\.rad/s in one sum; expected the same unit$"),
    ("unit that a number in one term mends not", 8, "<potential>m*(0.3*l + l)</potential>", 8, r"the potential has the unit kg\.m, expected kg.m2/s2$"),
    ("unit of a constant", 8, '<constant name="r" value="0.3" unit="kg"/><potential>m*g*(l + r)</potential>', 8, "m and kg in one sum; expected the same unit$"),
    ("unit of the value of a constant", 8, '<constant name="r" value="0.3" unit="m"/><constant name="M" value="r" unit="kg"/><potential>m*g*l*M/1</potential>', 8,
     "the value of the constant has the unit m, expected kg"),
    ("constant that takes its unit from another", 8, '<constant name="r" value="0.3" unit="kg"/><constant name="R" value="r"/><potential>m*g*(l + R)</potential>', 8,
     "m and kg in one sum"),
    ("unit of an argument", 8, "<potential>m*g*l*cos(l)</potential>", 8, "argument of cos has the unit m, expected 1 or rad"),
    ("unit of the potential", 8, "<potential>m*g</potential>", 8, "potential has the unit .*expected kg.m2/s2"),
    ("unit of a force", 9, '<force coordinate="theta">m*g</force>', 9, "unit mismatch: .*expected"),
    ("unit of an exponent", 8, "<potential>m*g*l*2^l</potential>", 8, "an exponent has the unit m, expected 1 or rad"),
    ("units of atan2", 8, "<potential>m*g*l*atan2(l, m)</potential>", 8, "m and kg in one atan2"),
    ("units of min", 8, "<potential>m*g*min(l, m)</potential>", 8, "m and kg in one min"),
    ("unit of a minimum", 8, "<potential>m*min(2, l)</potential>", 8, r"potential has the unit kg\.m, expected kg.m2/s2"),
    ("unit of an angle", 8, "<potential>atan2(m*g*l, m*g*l)</potential>", 8, "potential has the unit 1, expected kg.m2/s2"),
    ("unit of a power", 8, "<potential>m*g^2*l</potential>", 8, r"potential has the unit kg\.m3/s4, expected"),
    ("unit of a derivative", 10, '<output name="height" unit="m">der(bob.y)</output>', 10, "has the unit m/s, expected m"),
    ("unit of an output", 10, '<output name="height" unit="s">bob.y</output>', 10, "has the unit m, expected s"),
    ("unit of a position", 7, '<particle name="bob" mass="m" y="sin(theta)*m"/>', 7, "unit mismatch"),
    ("unknown unit", 2, '<parameter name="m" start="1" unit="lbs"/>', 2, "the unit 'lbs' is not known"),
    ("unit that is not coherent", 3, '<parameter name="l" start="1" unit="cm"/>', 3, "the unit 'cm' is not known"),
    ("name twice", 3, '<parameter name="m" start="1" unit="m"/>\n  <parameter name="l" start="1" unit="m"/>', 3,
     "'m' is already defined on line 2"),
    ("name of the language", 5, '<input name="sin" unit="N.m"/>\n  <input name="tau" unit="N.m"/>', 5, "'sin' belongs to the language"),
    ("name of a result", 5, '<input name="totalEnergy"/>\n  <input name="tau" unit="N.m"/>', 5, "belongs to the language"),
    ("velocity named as a parameter", 6, '<coordinate name="theta" velocity="g" unit="rad"/>', 6, "'g' is already defined on line 4"),
    ("min above max", 2, '<parameter name="m" start="1" min="2" max="0"/>', 2, "min 2 is larger than max 0"),
    ("start outside the range", 2, '<parameter name="m" start="-1" min="0"/>', 2, "start -1 is outside min and max"),
    ("start that is not a number", 2, '<parameter name="m" start="one"/>', 2, "unknown name 'one'"),
    ("start that is infinite", 2, '<parameter name="m" start="1/(1-1)"/>', 2, "division by zero|no finite value"),
    ("force without coordinate", 9, "<force>tau</force>", 9, 'the direction of <force> is not determined; expected coordinate='),
    ("force along nothing", 9, '<force coordinate="phi">tau</force>', 9, "no coordinate 'phi' for this force"),
    ("force on nothing", 9, '<force on="rod" x="1"/>', 9, "no particle, body, point or frame 'rod'"),
    ("particle without position", 7, '<particle name="bob" mass="m"/>', 7, "<particle> has no position; expected x, y or z"),
    ("mass that moves", 7, '<particle name="bob" mass="m*theta" y="l*cos(theta)"/>', 7, "cannot depend on coordinates"),
    ("position with a velocity", 7, '<particle name="bob" mass="m" y="l*cos(theta) + omega"/>', 7, "cannot depend on velocities"),
    ("potential with an input", 8, "<potential>m*g*bob.y + tau*theta</potential>", 8, "cannot depend on inputs, but 'tau' does"),
    ("no inertia", 7, '<particle name="bob" mass="m" y="l"/>', 6, "coordinate 'theta' has no inertia"),
    ("kinetic energy with a product alone", 6,
     '<coordinate name="theta" velocity="omega" unit="rad"/><coordinate name="u" velocity="w" unit="rad"/>\n<parameter name="J" start="1" unit="kg.m2"/><kinetic>J*(w*omega + omega^2/2)</kinetic>',
     6, "kinetic energy has no term with the square of 'w', .*not positive definite"),
    ("two coordinates for one motion", 7,
     '<coordinate name="phi" velocity="nu" unit="rad"/>\n'
     '<particle name="bob" mass="m" x="l*sin(theta + phi)" y="-l*cos(theta + phi)"/>', 0, "mass matrix is singular: the velocity of .* is not independent"),
    ("force along a coordinate with components", 9, '<force coordinate="theta" x="1">tau</force>', 9, "the direction of <force> is not determined; expected coordinate="),
    ("force on a particle without components", 9, '<force on="bob">tau</force>', 9, "the direction of <force> is not determined; expected coordinate="),
    ("force on a particle with a text", 9, '<force on="bob" x="1">tau</force>', 9, '<force on="bob"> contains text'),
    ("force along what a particle has not", 9, '<force on="bob" z="1"/>', 9, "a force along z on 'bob', which has no z"),
    ("two particles of one name", 7,
     '<particle name="bob" mass="m" x="l*sin(theta)" y="-l*cos(theta)"/>\n<particle name="bob" mass="m" z="l*theta"/>', 8,
     "named 'bob' is already defined on line 7"),
    ("work without forces", 9, "<work/>", 9, "<work/> has no forces"),
    ("series of a function with a kink", 11,
     '<force coordinate="theta">tau*asin(sin(theta))</force><solver method="taylor"/>', 11, "asin of a sine has a kink.*expected the method 'erk'"),
    ("series of another function with a kink", 11,
     '<force coordinate="theta">tau*acosh(cosh(theta))</force><solver method="taylor"/>', 11, "acosh of a cosh has a kink"),
    ("exact for a nonlinear system", 11, '<solver method="exact"/>', 11, "not linear.*a method other than 'exact'"),
    ("index that is not a number", 7, '<for index="i" from="1" to="n"></for>', 7, "unknown name 'n'"),
    ("index that is half", 7, '<for index="i" from="1" to="1.5"></for>', 7, "expected whole numbers"),
    ("endless repetition", 7, '<for index="i" from="1" to="1e9"></for>', 7, "at most 10000 repetitions"),
    ("index that is a parameter further below", 3,
     '<for index="g" from="1" to="2"><potential>9.81*l*m*g</potential></for><parameter name="l" start="1"/>', 3,
     "the index 'g' of <for> is already defined"),
    ("index that is an output", 11, '<for index="height" from="1" to="2"><potential>m*g*l</potential></for>', 11,
     "the index 'height' of <for> is already defined"),
    ("index that is a definition further below", 7,
     '<for index="a" from="1" to="2"><potential>m*g*l*a</potential></for><define name="a">2</define>'
     '<particle name="bob" mass="m" x="l*sin(theta)" y="-l*cos(theta)"/>', 7, "the index 'a' of <for> is already defined"),
    ("one index in two loops", 8,
     '<for index="i" from="1" to="2"><for index="i" from="1" to="2"><potential>m*g*l</potential></for></for>', 8,
     "the index 'i' of <for> is already defined"),
    ("constant after its use", 7, '<for index="i" from="1" to="N"></for><constant name="N" value="2"/>', 7, "unknown name 'N'"),
    ("sum over a number", 8, "<potential>m*g*l*sum(2, 1, 3, 2)</potential>", 8, "expected a name as the index of sum"),
    ("sum over a name", 8, "<potential>m*g*sum(l, 1, 2, l)</potential>", 8, r"the index 'l' of sum\(...\) is already defined"),
    ("sum of too many terms", 8, "<potential>m*g*l*sum(i, 1, 100001, 1)</potential>", 8, "more than 100000 terms"),
    ("one repetition too many", 7, '<for index="i" from="1" to="10001"></for>', 7, "at most 10000 repetitions"),
    ("half an index", 2, '<parameter name="m[1.5]" start="1" unit="kg"/>', 2, "is not a whole number that is known at build time"),
    ("start above max", 2, '<parameter name="m" start="3" max="2"/>', 2, "start 3 is outside min and max"),
    ("nominal value by a constant", 6,
     '<constant name="N" value="0"/><coordinate name="theta" velocity="omega" unit="rad" nominal="N"/>', 6, "nominal is 0; expected a positive number"),
    ("stop at the start", 12, '<experiment startTime="2" stopTime="2"/>', 12, "stopTime 2 is not after startTime 2"),
    ("sum that runs backwards", 8, "<potential>m*g*l*sum(i, 3, 1, i)</potential>", 8, "from 3 to 1 runs backwards"),
    ("negative index", 2, '<parameter name="m[-1]" start="1" unit="kg"/>', 2, r"the index of m\[-1\] is negative"),
    ("comment inside a number", 8, "<potential>m*g*l*2<!-- tens -->3</potential>", 8, "expected an operator or the end, found '3'"),
    ("index that is a name", 7, '<for index="m" from="1" to="2"></for>', 7, "'m' of <for> is already defined"),
    ("definition in a circle", 10, '<define name="a">b</define><define name="b">a</define>', 10, "in a circle: a -> b -> a; expected"),
    ("definition of itself", 10, '<define name="a">2*a</define>', 10, "in a circle: a -> a; expected"),
    ("longer circle, entered from outside", 10,
     '<define name="z">a</define>\n<define name="a">b + 1/(d - d)</define>\n<define name="b">l + c</define><define name="c">a</define><define name="d">2*l</define>', 11,
     "in a circle: a -> b -> c -> a; expected"),
    ("circle of components", 7, '<particle name="bob" mass="m" x="l*sin(theta) + arm.x" y="l*cos(theta)"/>\n<particle name="arm" mass="m" x="bob.x"/>', 7,
     r"in a circle: bob\.x -> arm\.x -> bob\.x"),
    ("mistake in a definition further below", 8, '<define name="a">b*2</define>\n<define name="b">m*G</define><potential>a*bob.y</potential>', 9,
     "unknown name 'G'; did you mean 'g'"),
    ("acceleration in a force", 9, '<force coordinate="theta">tau*der(omega)</force>', 9, "cannot depend on accelerations"),
    ("ampersand", 8, "<potential>m*g & l</potential>", 8, "a text has a bare '&'; write &amp;"),
    ("less than", 8, "<potential>m*g*max(0, l < 1)</potential>", 8, "'<' begins an element .*write &lt;"),
    ("less than in an attribute", 7, '<particle name="bob" mass="m" x="l<2"/>', 7, "'<' stands in an attribute, .*; write &lt;"),
    ("condition", 8, "<potential>m*g*l*(theta &lt; 1)</potential>", 8, r"write if\(x > 0"),
    ("choice", 8, "<potential>if(theta,1,2)*m*g*l</potential>", 8, "the condition 'theta' is not a comparison; expected one such as theta > 0"),
    ("part of a condition", 8, "<potential>if(theta > 0 and 2*theta , 1, 2)*m*g*l</potential>", 8, r"the condition '2\*theta' is not a comparison; expected one such as 2\*theta > 0"),
    ("mode as an index", 8, '<mode name="n" start="1"/><constant name="c" values="1 2"/><potential>m*g*l*c[n]</potential>', 8,
     r"the index in brackets cannot depend on modes, but 'n' does; expected numbers and constants; choose by if\(i > 1.5, c\[2\], c\[1\]\)"),
    ("unit of a floor", 8, '<force coordinate="theta">tau*floor(l)</force>', 8, r"the argument of floor has the unit m, expected 1; divide it by a step of this unit, as in step\*floor\(x/step\)"),
    ("root in a unit", 8, '<parameter name="k" start="1" unit="m3/(s.sqrt(Pa))"/>', 8, r"is not known; expected a decimal exponent for a root, as in Pa0.5 for sqrt\(Pa\)"),
    ("comma in a number", 4, '<parameter name="g" start="9,81" unit="m/s2"/>', 4, "write a point in numbers, as in 9.81"),
    ("power of other languages", 8, "<potential>m*g*l*theta**2</potential>", 8, r"write one \* for a product and \^ for a power"),
    ("function call of a variable", 8, "<potential>m*g*l(1 - cos(theta))</potential>", 8, r"'l' is not a function; write \* for a product"),
    ("square of other languages", 8, "<potential>m*g*l*sqr(2)</potential>", 8, "unknown function 'sqr'; write x\\^2"),
    ("and as a function", 8, "<potential>m*g*l*if(and(theta > 0, omega > 0), 1, 0)</potential>", 8, "unknown function 'and'; write and between two conditions, as in x > 0 and y > 0"),
    ("AND in capitals", 8, "<potential>m*g*l*if(theta > 0 AND omega > 0, 1, 0)</potential>", 8, "found 'AND'; write and, or in small letters"),
    ("mod as an operator", 8, "<output name=\"r\">theta mod 2</output>", 8, "found 'mod'; write mod\\(a, b\\)"),
    ("value before an event", 8, "<output name=\"r\">pre(theta)</output>", 8, "unknown function 'pre'; write the name alone, whose value in <set> is that before the event"),
    ("derivative of an input in a constraint of velocities", 8, '<input name="u" unit="rad" derivatives="1"/><constraint name="c" unit="rad/s">omega - der(u)</constraint>', 8,
     "the constraint 'c' needs the time derivative of 'der\\(u\\)'; expected derivatives=\"2\" of the <input> 'u'"),
    ("logarithm of other languages", 8, "<potential>m*g*l*ln(2)</potential>", 8, "unknown function 'ln'; write log for the natural"),
    ("millimetres", 3, '<parameter name="l" start="1" unit="mm"/>', 3, "'mm' is not known; expected m, and the value times 1e-3"),
    ("degrees", 6, '<coordinate name="theta" velocity="omega" unit="deg"/>', 6, "expected rad, and the value times pi/180"),
    ("unit in a number", 2, '<parameter name="m" start="0.5 kg"/>', 2, 'units in unit="..."'),
    ("input in a position", 7, '<particle name="bob" mass="m" y="l*cos(theta) + tau"/>', 7, "cannot depend on inputs, but 'tau' does; use it in a <force>"),
    ("derivative of an input", 10, '<output name="h">der(tau)</output>', 10, r"der\(...\) in the output 'h' cannot depend on inputs, but 'tau' does; expected coordinates or velocities"),
    ("derivative of an acceleration", 10, '<output name="h">der(der(omega))</output>', 10, r"cannot depend on accelerations, .*expected coordinates or velocities"),
    ("acceleration in a force by definition", 9, '<force coordinate="theta">der(omega)*m*l^2</force>', 9, "expected them in an <output> alone"),
    ("odd root of a negative number", 8, "<potential>(-8)^(1/3)*m*g*l</potential>", 8, r"sign\(x\)\*abs\(x\)\^n for an odd root"),
    ("definition named like an index", 11, '<for index="i" from="1" to="2"><define name="i">m</define></for>', 11, "'i' is the index of a <for> around it"),
    ("attribute without quotes", 2, '<parameter name=m start="1"/>', 2, "the value of an attribute is not in straight quotes"),
    ("no end", 13, "", 13, "the file ends inside an element"),
    ("attribute with another letter", 2, '<parameter name="m" start="1" units="kg"/>', 2, "<parameter> has no attribute 'units'; did you mean 'unit'"),
    ("attribute in upper case", 2, '<parameter Name="m" start="1"/>', 2, "no attribute 'Name'; did you mean 'name'"),
    ("attribute of a body at a particle", 7, '<particle name="bob" mass="m" y="l*cos(theta)" inertia="m*l^2"/>', 7,
     "<particle> has no attribute 'inertia'; expected name, in, mass, x, y or z"),
    ("body without its angle", 7, '<body name="bob" mass="m" y="l*cos(theta)" inertia="m*l^2"/>', 7, "the rotation of <body> is not determined; expected angle and inertia, or in="),
    ("attribute of an energy", 8, '<potential name="U">m*g*bob.y</potential>', 8, "<potential> has no attribute 'name'; expected none"),
    ("element in upper case", 2, '<Parameter name="m" start="1"/>', 2, "<Parameter> is not an element of <system>; did you mean 'parameter'"),
    ("element of another language", 8, "<lagrangian>-m*g*bob.y</lagrangian>", 8, "<lagrangian> is not an element of <system>; write .*<kinetic> and <potential>"),
    ("element that is unknown", 8, "<rope/>", 8, "<rope> is not an element of <system>; expected constant, parameter, .* work, solver, experiment, preset or task"),
    ("element that stands elsewhere", 12, '<for index="i" from="1" to="2"><experiment/></for>', 12,
     "<experiment> cannot stand in <for>; expected constant, .*, output, for or include$"),
    ("element in an element without content", 7, '<particle name="bob" mass="m" y="l*cos(theta)"><potential>m*g*bob.y</potential></particle>', 7,
     "<potential> stands inside of <particle>; expected the end of <particle> before it"),
    ("element in an expression", 8, "<potential>\n m*g*<b>bob.y</b></potential>", 9, "<b> stands inside of <potential>"),
    ("text among elements", 8, "<potential>m*g*bob.y</potential>\n\n  m*g + l", 10, "the text 'm\\*g' stands in <system>; expected it in an element"),
    ("text in an element without content", 11, "<solver method='erk'>bdf</solver>", 11, "the text 'bdf' stands in <solver>; expected it in an attribute"),
    ("empty element", 8, "<potential/>", 8, "<potential> is empty; expected an expression in it"),
    ("empty attribute", 2, '<parameter name="m" start=""/>', 2, 'start="" of <parameter> is empty; expected a value'),
    ("name of Greek letters", 6, '<coordinate name="θ" velocity="omega"/>', 6, 'name="θ" of <coordinate> is not a name; expected letters a to z.*index as in'),
    ("name that is too long", 2, f'<parameter name="{201 * "m"}" start="1"/>', 2, "of <parameter> is too long; expected at most 200 characters"),
    ("solver in upper case", 11, '<solver method="Taylor"/>', 11, "is not known; did you mean 'taylor'"),
    ("time with its unit", 12, '<experiment stopTime="10 s"/>', 12, 'stopTime="10 s" of <experiment> is not a number; expected one such as'),
    ("name of a system with a dash", 1, '<system name="my-system">', 1, 'name="my-system" of <system> is not a name; expected letters a to z, digits and _, with no digit first$'),
    ("another root", 1, "<model/>", 2, "the file has text after the end of its first element"),
    ("namespace", 1, '<system name="Broken" xmlns="urn:mine">', 1, "<system> belongs to the namespace 'urn:mine'; expected no xmlns"),
    ("quote missing", 2, '<parameter name="m start="1"/>', 2, "attributes do not follow each other; expected .*both quotes and a blank"),
    ("attribute without a value", 2, '<parameter name="m" start/>', 2, "the attribute 'start' has no value"),
    ("attribute twice", 2, '<parameter name="m" start="1" start="2"/>', 2, "the attribute 'start' is given twice"),
    ("dashes in a comment", 2, '<!-- mass -- of the bob --><parameter name="m" start="1"/>', 2, "'--' stands inside of <!--"),
    ("comment without end", 2, '<!-- mass', 13, "a comment has no end; expected -->"),
    ("entity of other languages", 8, "<potential>m&middot;g*bob.y</potential>", 8, "'&middot;' is not known; .* \\* for a product"),
    ("declaration further down", 2, '<?xml version="1.0"?><parameter name="m" start="1"/>', 2, "<.xml ....> stands further down; expected it at the very beginning"),
    ("unknown encoding", 1, '<?xml version="1.0" encoding="mine"?><system name="Broken">', 1, "does not match the encoding of its first line.*expected UTF-8"),
    ("control character", 8, "<potential>m*g\a*bob.y</potential>", 8, "there is an invisible character here"),
    ("function without parentheses", 7, '<particle name="bob" mass="m" y="l*cos theta"/>', 7, r"'cos' is not a variable but a function; .*as in cos\(...\)"),
    ("result in an expression", 10, '<output name="a">kineticEnergy</output>', 10, "'kineticEnergy' is not a variable but a result"),
    ("thousands", 2, '<parameter name="m" start="1,000"/>', 2, "found ','; write a point in numbers, .* nothing between thousands"),
    ("thousands with a blank", 2, '<parameter name="m" start="1 000"/>', 2, "found '000'; .* nothing between thousands"),
    ("no number as a value", 2, '<parameter name="m" start="NaN"/>', 2, "unknown name 'NaN'; a value must be a finite number"),
    ("limit that is infinite", 2, '<parameter name="m" start="1" max="inf"/>', 2, "leave out a limit"),
    ("stop whose ends are exchanged", 10, '<stop coordinate="theta" min="2" max="0.5"/>', 10,
     "max - min of the <stop> of 'theta' is -1.5 at the start values; expected none below 0"),
    ("stop whose ends are exchanged by a parameter", 10, '<parameter name="w" start="-1" unit="rad"/><stop coordinate="theta" min="-w" max="w"/>', 10,
     "max - min of the <stop> of 'theta' is -2 at the start values"),
    ("contact that nothing moves", 10, '<contact name="c" gap="1"/>', 10, "the gap of the contact 'c' contains no coordinate; expected an expression such as y - r"),
    ("stop of what is not a name yet", 10, '<coordinate name="x[2]" velocity="v[2]"/>\n<stop coordinate="x[N]" min="0"/>\n<constant name="N" value="2"/>', 11,
     "coordinate: the index in brackets: unknown name 'N'; expected a number, or a constant that is defined above"),
    ("unknown name in a number", 2, '<parameter name="m" start="mass"/>', 2, "unknown name 'mass'; expected a number, or a constant that is defined above"),
    ("time of other languages", 9, '<force coordinate="theta">tau*sin(t)</force>', 9, "unknown name 't'; write time"),
    ("velocity of other languages", 10, '<output name="a">theta_dot</output>', 10, r"unknown name 'theta_dot'; write der\(...\)"),
    ("component that is not there", 10, '<output name="a">bob.z</output>', 10, r"unknown name 'bob\.z'; expected bob\.x or bob\.y"),
    ("particle as a value", 8, '<define name="a">bob</define><potential>m*g*bob.y</potential>', 8, r"unknown name 'bob'; expected bob\.x or bob\.y"),
    ("equation", 8, "<potential>U = m*g*bob.y</potential>", 8, "unknown name 'U'; write the value alone, without a name and ="),
    ("index in parentheses", 11, '<parameter name="k[1]" start="1"/><potential>m*g*l*k(1)</potential>', 11, r"'k' is not a function; write k\[...\] for an index"),
    ("degrees after a number", 6, '<coordinate name="theta" velocity="omega" start="60deg"/>', 6, "'60deg' is not a number; write radians, as in 60\\*pi/180"),
    ("degrees in a number", 6, '<coordinate name="theta" velocity="omega" start="30°"/>', 6, "found '°'; write radians, as in 30\\*pi/180"),
    ("dash as a minus sign", 8, "<potential>m*g*l – 1</potential>", 8, "found '–'; write - for a minus sign"),
    ("long dash as a minus sign", 8, "<potential>m*g*l — 1</potential>", 8, "found '—'; write - for a minus sign"),
    ("curly quotes around a value", 2, '<parameter name=“m” start=“1”/>', 2, "the value of an attribute is not in straight quotes; expected name=\"value\""),
    ("angular quotes around a value", 2, '<parameter name=«m» start="1"/>', 2, "not in straight quotes"),
    ("blank that is none", 8, "<potential>m*g*\u00a0bob.y</potential>", 8, "write a plain blank"),
    ("velocity in place of its coordinate", 9, '<force coordinate="omega">tau</force>', 9, "no coordinate 'omega' for this force; did you mean 'theta', whose velocity"),
    ("coordinate in upper case", 9, '<force coordinate="Theta">tau</force>', 9, "no coordinate 'Theta' for this force; did you mean 'theta'"),
    ("particle in upper case", 9, '<force on="Bob" x="tau/l"/>', 9, "no particle, body, point or frame 'Bob' for this force; did you mean 'bob'"),
    ("one name in all repetitions", 11, '<for index="i" from="1" to="2"><parameter name="k" start="1"/></for>', 11,
     r"the name 'k' is already defined on line 11; .* or an index such as \[i\]"),
    ("exponent of other languages", 4, '<parameter name="g" start="9.81" unit="m/s^2"/>', 4, "expected exponents as plain digits, as in m2"),
    ("product of units", 5, '<input name="tau" unit="N*m"/>', 5, r"expected a point between units, as in N\.m"),
    ("unit in words", 2, '<parameter name="m" start="1" unit="kilogram"/>', 2, "'kilogram' is not known; expected kg$"),
    ("unit that is empty", 2, '<parameter name="m" start="1" unit=""/>', 2, "expected 1 for a pure number, or no unit"),
    ("unit in brackets", 2, '<parameter name="m" start="1" unit="[kg]"/>', 2, "expected it without brackets"),
    ("negative kinetic energy", 7, '<define name="y">-l*cos(theta)</define><kinetic>-m*l^2*omega^2/2</kinetic><particle name="bob" mass="0" y="y"/>', 6,
     "the kinetic energy is not positive definite at the start values: it is negative for a motion along 'theta'"),
    ("kinetic energy of a saddle", 10,
     '<coordinate name="x" velocity="v" unit="m"/><kinetic>m*v^2/2 + 2*m*l*v*omega</kinetic>', 10,
     "not positive definite at the start values: it is negative for a motion along 'x'"),
    ("error on a later line of an expression", 8, "<potential>\n  m*g*bob.y\n  + nothing\n</potential>", 10, "'nothing'"),
    ("error after a sum of several lines", 8, "<potential>m*g*l*sum(i, 1, 3,\n  sqrt(theta)\n  + i)\n  + nothing</potential>", 11, "'nothing'"),
]


def broken(line, text):
    lines = RIGHT.splitlines()
    lines[line - 1] = text
    return "\n".join(lines)


def compile_text(text, folder, *words):
    (folder / "system.xml").write_text(text)
    return lagc("system.xml", "-o", "out", *words, cwd=folder)


def test_the_valid_system_compiles(tmp_path):
    result = compile_text(RIGHT, tmp_path)
    assert (result.returncode, result.stderr) == (0, "")


@pytest.mark.parametrize("what, line, text, expected_line, message", CASES, ids=[case[0] for case in CASES])
def test_broken_system(what, line, text, expected_line, message, tmp_path):
    result = compile_text(broken(line, text), tmp_path)
    assert result.returncode == 1
    first = result.stderr.splitlines()[0]
    place = f"system.xml:{expected_line}:" if expected_line else r"system.xml:\d+:"
    assert re.match(f"{place} .*({message})", first), result.stderr
    assert not re.search("facet|atomic type|Element '|content type|cvc|Expected is|xs:", result.stderr)
    assert not (tmp_path / "out").exists()
    assert result.stdout == ""


# Likely mistakes: lagc writes the FMU's sources and a warning.
WARNINGS = [
    ("root of a negative start", 8, "<potential>m*g*l*sqrt(theta - 2)</potential>", 8, "the base of a root or fractional power is -1"),
    ("fractional power", 8, "<potential>m*g*l*(\ntheta - 2)^1.5</potential>", 9, "the base of a root or fractional power is -1"),
    ("logarithm", 8, "<potential>m*g*l*log(theta - 1)</potential>", 8, r"log\(0\) has no finite value at the start values; expected .* positive"),
    ("arc sine", 8, "<potential>m*g*l*asin(2*theta)</potential>", 8, r"asin\(2\) has no finite value at the start values; expected .* -1 to 1"),
    ("arc cosine", 10, '<output name="a">acos(-1.5*theta)</output>', 10, r"acos\(-1.5\) has no finite value at the start values"),
    ("area cosine", 8, "<potential>m*g*l*acosh(theta/2)</potential>", 8, r"acosh\(0.5\) has no finite value at the start values"),
    ("area tangent", 8, "<potential>m*g*l*atanh(theta)</potential>", 8, r"atanh\(1\) has no finite value at the start values"),
    ("mass of 0", 2, '<parameter name="m" start="0" unit="kg"/>', 7, "the mass of 'bob' is 0 at the start values"),
    ("inertia below 0", 7, '<body name="bob" mass="m" inertia="-m*l^2/2" x="l*theta" angle="theta"/>', 7, "the inertia of 'bob' is -0.5 at the start values"),
    ("unit forgotten", 3, '<parameter name="l" start="1"/>', 3, "'l' has no unit, so that units are not checked where it is used"),
    ("unit of an input forgotten", 5, '<input name="tau"/>', 5, "'tau' has no unit"),
    ("unit of a coordinate forgotten", 6, '<coordinate name="theta" velocity="omega" start="1"/>', 6, "'theta' has no unit"),
    ("unit of a number", 8, "<potential>m*g*(l + 0.5*cos(theta))</potential>", 8,
     'm and 1 in one sum; .*; 0.5 is a number without a unit: .* write it as <constant name="..." value="0.5" unit="m"/>$'),
    ("unit of a number that is not a multiple of a half", 8, "<potential>m*g*(l + 0.4*cos(theta))</potential>", 8, 'value="0.4" unit="m"'),
    ("unit of a measured number", 8, "<potential>2*9.81*m*bob.y</potential>", 8, 'has the unit .*, expected kg.m2/s2; .* value="9.81" unit="m/s2"'),
    ("unit of a divisor", 8, "<potential>m*g*l*exp(-l/0.25)</potential>", 8, 'argument of exp has the unit m, expected 1 .* value="0.25" unit="m"'),
    ("unit of a number in a power", 8, "<potential>m*g*(l + l*(3*l)^2)</potential>", 8, 'm and m3 in one sum; .* value="3" unit="1/m"'),
    ("unit of a number in a comparison", 8, "<potential>m*g*if(theta &gt; 0.3, l, 0.7*theta)</potential>", 8, 'value="0.7" unit="m"'),
    ("unit of a constant", 8, '<constant name="r" value="0.3"/><potential>m*g*(l + r*cos(theta))</potential>', 8,
     "'r' is a number without a unit: if it has one, add unit=\"m\"$"),
    ("unit in a definition", 8, '<define name="h">0.3*cos(theta)</define>\n<potential>m*g*(l + h)</potential>', 9, 'value="0.3" unit="m"'),
    ("unit of a number that is repeated", 8, "<potential>m*g*sum(i, 1, 3, l + 0.5*theta)</potential>", 8, 'value="0.5" unit="m"'),
    ("dissipation with the sign of a force", 11, '<parameter name="b" start="3" unit="N.m.s"/>\n<dissipation>-b*omega^2/2</dissipation>', 12,
     r"the dissipation is -1\.5 for velocities of \+-1 at the start values"),
    ("dissipation of two velocities with a wrong sign", 11,
     '<parameter name="b" start="3" unit="N.m.s"/><coordinate name="x" velocity="v" unit="rad"/><kinetic>m*l^2*v^2/2</kinetic>\n'
     '<dissipation>-b*(v - omega)^2/2</dissipation>', 12, "the dissipation is -6 for velocities"),
    ("dissipation without velocities", 11, "<dissipation>m*g*l*theta/time</dissipation>", 11, "the dissipation has no velocities, and makes no force"),
    ("tolerance below all numbers", 11, '<solver method="erk" tolerance="1e-20"/>', 11, "tolerance 1e-20 is below the rounding error of doubles"),
    ("loop that runs backwards", 11, '<for index="i" from="3" to="1"><potential>m*g*l</potential></for>', 11,
     "<for> from 3 to 1 runs backwards"),
]


@pytest.mark.parametrize("what, line, text, expected_line, message", WARNINGS, ids=[case[0] for case in WARNINGS])
def test_warnings(what, line, text, expected_line, message, tmp_path):
    result = compile_text(broken(line, text).replace("bob.y", "l"), tmp_path)
    assert result.returncode == 0
    assert re.fullmatch(f"system.xml:{expected_line}: warning: .*({message}).*\n", result.stderr), result.stderr
    assert (tmp_path / "out" / "system.c").exists()


QUIET = [
    ("dissipation of a motion with a belt", 11, '<parameter name="b" start="3" unit="N.m.s"/><dissipation>b*(omega - 2)^2/2 - tau*omega</dissipation>'),
    ("numbers that stand alone", 8, "<potential>m*g*(l + 0.3 + max(l, 2*0.4) + if(l &gt; 0.5, l, -1))</potential>"),
    ("dissipation that is a force", 11, '<dissipation>-m*g*l*omega</dissipation>'),
    ("no repetitions", 11, '<constant name="N" value="0"/><for index="i" from="1" to="N"></for>'),
    ("none for the first index", 11,
     '<for index="i" from="1" to="3"><for index="j" from="2" to="i-1"><potential>m*g*l</potential></for></for>'),
    ("logarithm of a time that begins later", 12, '<experiment startTime="1" stopTime="10"/><output name="o">log(time)</output>'),
    ("longest sum", 8, "<potential>m*g*l*sum(i, 1, 100000, 1)</potential>"),
    ("longest repetition", 11, '<for index="i" from="1" to="10000"></for>'),
    ("index again", 8, "<potential>m*g*l*(sum(i, 1, 2, i) + sum(i, 1, 3, i))</potential>"),
    ("number beside a unit", 8, "<potential>m*g*max(0, min(l, 3))</potential>"),
    ("unit of a constant", 8, '<constant name="r" value="0.3" unit="m"/><potential>m*g*(l + r*cos(theta))</potential>'),
    ("several turns", 11, '<frame name="f"><rotate axis="z" angle="4*pi"/></frame>'),
    ("empty sum", 8, '<for index="i" from="1" to="3"><potential>m*g*l*sum(j, 3, i-1, j)</potential></for>'),
    ("point without mass", 11, '<particle name="tip" mass="0" x="2*l*sin(theta)"/><force on="tip" x="tau/l"/>'),
    ("unit of a pure number", 11, '<parameter name="a" start="1" unit="1"/>'),
    ("root at its end", 8, "<potential>m*g*l*sqrt(theta - 1)</potential>"),
    ("definition of one further below", 11, '<define name="a">2*b</define><define name="b">3*l</define>'),
    ("root of a definition further below", 11, '<define name="a">sqrt(theta - 2 + b)/b</define><define name="b">5*l/l</define>'),
    ("comment between words", 8, "<potential>m*g<!-- not 9.81 -->*bob.y</potential>"),
]


@pytest.mark.parametrize("what, line, text", QUIET, ids=[case[0] for case in QUIET])
def test_no_warning(what, line, text, tmp_path):
    result = compile_text(broken(line, text), tmp_path)
    assert (result.returncode, result.stderr) == (0, "")


@pytest.mark.parametrize("text, message", [
    (b"", "1: the file does not begin with an element; expected <system"),
    (b"\n \n", "3: the file does not begin with an element"),
    (bytes(range(256)), "1: the file does not begin with an element"),
    (RIGHT.replace("Pendulum", "P\u00e9ndulum").encode("latin-1"), "1: .*an encoding other than UTF-8; save it in UTF-8"),
    (RIGHT.replace("system", "System").encode(), "1: the file begins with <System>; expected <system name="),
    ((RIGHT + RIGHT).encode(), "14: the file has text after the end of its first element"),
])  # fmt: skip
def test_files_without_a_system(text, message, tmp_path):
    (tmp_path / "system.xml").write_bytes(text)
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 1
    assert re.fullmatch(f"system.xml:({message}).*\n", result.stderr), result.stderr


@pytest.mark.parametrize("element", ["event", "sample"])
def test_events_without_coordinates_and_states(element, tmp_path):
    trigger = {"event": 'event when="time > 1"', "sample": 'sample every="1"'}[element]
    text = f"""<system name="Q">\n<mode name="n"/><{trigger}><set mode="n">n + 1</set></{element}>\n<output name="y">n</output></system>"""
    (tmp_path / "system.xml").write_text(text)
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 1 and re.fullmatch(f"system.xml:2: an? <{element}> needs coordinates or states.*; expected a <state>, such as .*\n", result.stderr), result.stderr


@pytest.mark.parametrize("version", ["1.1", "1.2", "0.0"])
def test_another_version_of_xml(version, tmp_path):
    """lagc reads the file with a warning, as XML 1.0 requires for 1.x."""
    result = compile_text(f'<?xml version="{version}"?>\n{RIGHT}', tmp_path)
    assert (result.returncode, result.stderr) == (0, "system.xml:1: warning: the first line names a version of XML other than 1.0; expected <?xml version=\"1.0\"?>, or no such line\n")


@pytest.mark.parametrize("first", ["\n", "<!-- a\n", "<!-- <?xml\n--> <!-- b -->"])
def test_a_declaration_after_comments(first, tmp_path):
    """Messages about lines below it stay right."""
    end = "-->" if first.endswith("a\n") else ""
    text = f'{first}{end}<?xml version="1.0" encoding="UTF-8"\n?>\n{RIGHT}'
    result = compile_text(text, tmp_path)
    warning = "system.xml:2: warning: <?xml ...?> stands further down; expected it at the very beginning of the file, or left out\n"
    assert (result.returncode, result.stderr) == (0, warning)
    result = compile_text(text.replace("<particle ", "<particel "), tmp_path)
    assert result.returncode == 1 and f"system.xml:{text[:text.index('<particle ')].count(chr(10)) + 1}: " in result.stderr


def test_a_missing_file_is_reported_once(tmp_path):
    result = lagc("missing.xml", "-o", "out", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (1, "missing.xml: cannot be read; expected an XML file\n")


def test_other_encodings_that_a_file_names(tmp_path):
    (tmp_path / "system.xml").write_bytes(RIGHT.encode("utf-16"))
    result = lagc("system.xml", "-o", "out", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")


def test_unit_checks_need_units(tmp_path):
    result = compile_text(re.sub(' unit="[^"]*"', "", RIGHT), tmp_path)
    assert (result.returncode, result.stderr) == (0, "")


def test_linearization_at_a_pole(tmp_path):
    (tmp_path / "system.xml").write_text(broken(8, "<potential>m*g*l*log(theta)</potential>"))
    result = lagc("--linearize", "system.xml", "--at", "theta=0", cwd=tmp_path)
    assert result.returncode == 1
    assert re.search(r"system.xml:6: the equation of der\(omega\) has a coefficient that is not finite", result.stderr)


COHERENT = "coherent SI units such as kg, m, s, rad, N, J, W, Hz, joined by '.' and '/', for example kg.m2/s2 or N/(m.s)"


@pytest.mark.parametrize("unit, remedy", [
    ("cm", "m, and the value times 1e-2"),
    ("cm2", "m2, and the value times 1e-4"),
    ("cm-1", "m-1, and the value times 1e2"),
    ("kg.cm2", "kg.m2, and the value times 1e-4"),
    ("g/cm3", "kg/m3, and the value times 1e3"),
    ("N/cm", "N/m, and the value times 1e2"),
    ("km/h", "m/s, and the value times 1/3.6"),
    ("km/h2", "m/s2, and the value times 1/12960"),
    ("1/min", "1/s, and the value times 1/60"),
    ("min", "s, and the value times 60"),
    ("kN/m", "N/m, and the value times 1e3"),
    ("N/(mm.min)", "N/(m.s), and the value times 1/0.06"),
    ("deg/s", "rad/s, and the value times pi/180"),
    ("°/s", "rad/s, and the value times pi/180"),
    ("deg2", "rad2, and the value times pi^2/32400"),
    ("N.m/deg", "N.m/rad, and the value times 180/pi"),
    ("rpm", "rad/s, and the value times pi/30"),
    ("mm/s2", "m/s2, and the value times 1e-3"),
    ("N.cm", "N.m, and the value times 1e-2"),
    ("Nm/rad", "N.m/rad, with a point between units"),
    ("meter/sec", "m/s"),
    ("rpm/s", COHERENT),
    ("rpm2", COHERENT),
    ("Nm2", COHERENT),
    ("1/Nm", COHERENT),
    ("cm.lbs", COHERENT),
    ("cm21", COHERENT),
    ("%/s", "1/s, and the value times 1e-2"),
])  # fmt: skip
def test_values_in_other_units(unit, remedy, tmp_path):
    """The message names the factor to SI units; the expected factors are computed by hand."""
    result = compile_text(broken(2, f'<parameter name="m" start="1" unit="{unit}"/>'), tmp_path)
    assert result.stderr == f"system.xml:2: the unit '{unit}' is not known; expected {remedy}\n"


def test_too_many_nested_loops(tmp_path):
    """lagc reports the loop once, and nothing about the unread rest of the file."""
    inner = '<for index="k" from="1" to="10000"></for>'
    loops = f'<for index="i" from="1" to="10000">\n<for index="j" from="1" to="10000">\n{inner}</for></for>\n'
    result = compile_text(broken(11, loops + '<solver method="erk" tolerance="1e-8"/>'), tmp_path)
    assert re.fullmatch("system.xml:13: <for>: the system is too large: more than .* steps .*; expected fewer .*\n", result.stderr), result.stderr


def test_several_errors_in_one_run(tmp_path):
    text = broken(8, "<potential>m*G*bob.y</potential>").replace(">tau<", ">tua<").replace('unit="m/s2"', 'unit="gal"')
    result = compile_text(text, tmp_path)
    assert re.findall(r"system.xml:(\d+):", result.stderr) == ["4", "8", "9"]


def test_one_mistake_in_a_long_loop(tmp_path):
    """lagc prints the first hundred messages, each with its suggestion, and searches no suggestions for the others."""
    loop = '<for index="i" from="1" to="10000"><parameter name="p[i]" start="1"/><potential>q[i]*bob.y</potential></for>'
    result = compile_text(broken(11, loop), tmp_path)
    lines = result.stderr.splitlines()
    assert result.returncode == 1 and len(lines) == 101
    assert all(f"unknown name 'q[{i}]'; did you mean 'p[{i}]'?" in line for i, line in enumerate(lines[:100], 1))
    assert lines[100] == "system.xml: more errors follow; correct these first"


def test_old_output_goes_when_the_system_breaks(tmp_path):
    """An invalid system.xml removes the old system.c, which the build would otherwise compile."""
    compile_text(RIGHT, tmp_path)
    assert (tmp_path / "out" / "system.c").exists()
    compile_text(broken(8, "<potential>m*G</potential>"), tmp_path)
    assert not (tmp_path / "out" / "system.c").exists()


@pytest.mark.parametrize(
    "words, message",
    [
        (["missing.xml", "-o", "out"], "missing.xml.*expected an XML file"),
        (["system.xml", "-o", "/proc/nothing"], "cannot write into"),
        (["system.xml", "-o", "out", "--solver", "euler"], "euler.*expected taylor, erk, bdf, radau, auto or exact"),
        (["system.xml", "-o", "out", "-D", "N=3"], "no <constant> of this name"),
        (["--linearize", "system.xml", "--at", "alpha=1"], "'alpha'"),
        (["--linearize", "system.xml", "--at", "m=1"], "'m'; expected a coordinate, a velocity, a state or an input"),
        (["--linearize", "system.xml", "--at", "theta"], "--at theta names no value; expected NAME=VALUE"),
        (["--linearize", "system.xml", "--at", "theta=30kg"], "--at theta: '30kg' is in kg; expected a value in rad"),
        (["--linearize", "system.xml", "--at", "theta=3furlong"], "--at theta: the unit 'furlong' of '3furlong' is not known; expected a value in rad"),
        (["system.xml"], "usage"),
        (["system.xml", "-o"], "usage"),
        (["--nonsense"], "usage"),
        ([], "usage"),
    ],
)
def test_bad_command_lines(words, message, tmp_path):
    (tmp_path / "system.xml").write_text(RIGHT)
    result = lagc(*words, cwd=tmp_path)
    assert result.returncode == 1
    assert re.search(message, result.stderr)
    assert not (tmp_path / "out").exists()


def test_files_beyond_the_limit_of_the_user(tmp_path):
    """A file-size limit gives one line, as a full disk does, and no partial file."""
    (tmp_path / "system.xml").write_text(RIGHT)
    result = subprocess.run(
        [LAGC, "system.xml", "-o", "out"], cwd=tmp_path, capture_output=True, text=True,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (2000, 2000)),
    )  # fmt: skip
    assert result.returncode == 1
    assert re.fullmatch("system.xml: cannot write into 'out': File too large; expected .*\n", result.stderr)
    assert not [path for path in (tmp_path / "out").rglob("*") if path.is_file()]


def test_point_that_is_no_equilibrium(tmp_path):
    """lagc warns: the linear system is then the tangent at the point, with a constant term."""
    (tmp_path / "system.xml").write_text(RIGHT)
    result = lagc("--linearize", "system.xml", "--at", "theta=1", cwd=tmp_path)
    assert result.returncode == 0
    assert re.search("warning: the operating point is not an equilibrium", result.stderr)


LINEARIZATION = '<linearization of="{}" name="Line">\n  <at name="theta" value="0"/>\n{}</linearization>\n'


@pytest.mark.parametrize(
    "of, line, expected",
    [
        ("missing.xml", "", r"missing.xml.*expected an XML file"),
        ("line.xml", "", "line.xml:1: the file linearizes another linearization"),
        ("system.xml", '<at name="theta" value="1"/>\n', "line.xml:3: the operating point sets 'theta' twice"),
        ("system.xml", '<at name="alpha" value="1"/>\n', "line.xml:3: the operating point sets 'alpha'; expected a coordinate"),
        ("system.xml", '<at name="omgea" value="1"/>\n', "line.xml:3: the operating point sets 'omgea', which does not exist; did you mean 'omega'"),
        ("system.xml", '<at name="omega" value="g"/>\n', "line.xml:3: unit mismatch"),
        ("system.xml", '<parameter name="a" start="1"/>\n', "line.xml:3: .*parameter"),
    ],
)
def test_broken_linearizations(of, line, expected, tmp_path):
    (tmp_path / "system.xml").write_text(RIGHT)
    (tmp_path / "line.xml").write_text(LINEARIZATION.format(of, line))
    result = lagc("line.xml", "-o", "out", cwd=tmp_path)
    assert result.returncode == 1
    assert re.search(expected, result.stderr)
    assert not (tmp_path / "out").exists()


def test_long_and_deep_expressions(tmp_path):
    """lagc accepts 10,000 terms and 1,000 nested parentheses; more parentheses are an error and never crash it."""
    wide = " + ".join(f"{i % 7 + 1}*m*g*bob.y/10000" for i in range(10000))
    deep = "(" * 1000 + "m*g*bob.y" + ")" * 1000
    for expression in (wide, deep):
        result = compile_text(broken(8, f"<potential>{expression}</potential>"), tmp_path)
        assert (result.returncode, result.stderr) == (0, "")
    for nesting in (1001, 100000):
        expression = "(" * nesting + "m*g*bob.y" + ")" * nesting
        result = compile_text(broken(8, f"<potential>{expression}</potential>"), tmp_path)
        assert result.returncode == 1 and "parentheses or powers are nested more than 1000 deep" in result.stderr
    result = compile_text(broken(8, f"<potential>{'-' * 200000}m*g*l</potential>"), tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    for text in ("m*g*l" + "^2" * 5000, "cos(" * 5000 + "1" + ")" * 5000):
        result = compile_text(broken(8, f"<potential>{text}</potential>"), tmp_path)
        assert result.returncode == 1 and "system.xml:8: the potential: parentheses or powers are nested more than 1000 deep" in result.stderr


def test_external_entities_are_not_read(tmp_path):
    """A system.xml from elsewhere cannot make lagc read other files."""
    (tmp_path / "secret").write_text("m*g*l")
    text = '<!DOCTYPE system [<!ENTITY secret SYSTEM "secret">]>\n' + broken(8, "<potential>&secret;</potential>")
    result = compile_text(text, tmp_path)
    assert result.returncode == 1 and "m*g*l" not in result.stderr


def test_every_system_compiles_without_messages(name, tmp_path):
    """lagc prints nothing but the notes about the nodes of integrals."""
    result = lagc(ROOT / "fmu" / name / "system.xml", "-o", tmp_path / "out")
    words = re.sub(r"^\S+: note: integral\(.* is exact to 1e-13 by \d+ nodes? near the start values\n", "", result.stderr, flags=re.M)
    assert (result.returncode, result.stdout, words) == (0, "", "")


def names_of(folder):
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file())


FILES = ["documentation/index.html", "documentation/licenses/license.txt", "fmi3/flange.png", "fmi3/flange.svg", "fmi3/icon.svg", "fmi3/modelDescription.xml",
         "fmi3/terminalsAndIcons.xml", "model.png", "modelDescription.xml", "system.c"]


@pytest.mark.parametrize("limit", [0, 1, 4096, 7000])
def test_stopped_while_it_writes(limit, tmp_path):
    """An interrupted run leaves no partial output that the build would use, whichever file exceeded the limit."""
    compile_text(RIGHT, tmp_path)
    before = {name: (tmp_path / "out" / name).read_bytes() for name in FILES}
    assert limit < max(map(len, before.values()))
    (tmp_path / "system.xml").write_text(RIGHT.replace("height", "level"))
    words = [LAGC, "system.xml", "-o", "out"]
    result = subprocess.run(
        words, cwd=tmp_path, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
    )
    assert result.returncode == 1 and names_of(tmp_path / "out") == []
    assert subprocess.run(words, cwd=tmp_path).returncode == 0
    assert names_of(tmp_path / "out") == FILES and b"level" in (tmp_path / "out" / "system.c").read_bytes()


def test_a_full_disk(tmp_path):
    """A failing write without a signal leaves no partial output either."""
    compile_text(RIGHT, tmp_path)

    def fill():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))

    result = subprocess.run(
        [LAGC, "system.xml", "-o", "out"], cwd=tmp_path, preexec_fn=fill, restore_signals=False, capture_output=True
    )
    assert result.returncode == 1 and b"cannot write into 'out': File too large" in result.stderr
    assert names_of(tmp_path / "out") == []


def test_a_file_that_cannot_be_replaced(tmp_path):
    (tmp_path / "out" / "modelDescription.xml").mkdir(parents=True)
    (tmp_path / "out" / "modelDescription.xml" / "mine").write_text("")
    result = compile_text(RIGHT, tmp_path)
    assert result.returncode == 1 and "cannot write into 'out'" in result.stderr
    assert names_of(tmp_path / "out") == ["modelDescription.xml/mine"]


def test_without_memory(tmp_path):
    (tmp_path / "system.xml").write_text(RIGHT.replace("</system>", '<for index="i" from="1" to="10000"><output name="y[i]">sin(i*theta)*exp(theta/i)*der(omega)</output></for></system>'))
    limit = 80 << 20
    result = subprocess.run(
        [LAGC, "system.xml", "-o", "out"], cwd=tmp_path, capture_output=True, text=True,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)),
    )  # fmt: skip
    assert result.returncode == 1 and re.fullmatch("lagc: out of memory: .*; expected .*\n", result.stderr)
    assert not (tmp_path / "out" / "system.c").exists()


def test_version():
    result = lagc("--version")
    assert result.returncode == 0 and re.fullmatch(r"lagc \d+\.\d+\.\d+\n", result.stdout)


def test_the_point_may_contain_functions_with_commas(tmp_path):
    (tmp_path / "system.xml").write_text(RIGHT)
    results = [
        lagc("--linearize", "system.xml", "--at", point, cwd=tmp_path)
        for point in ("theta=atan2(0, 2),omega=max(0, min(0, 1)),tau=0", "theta=0,omega=0,tau=0")
    ]
    assert results[0].returncode == 0 and results[0].stdout == results[1].stdout


def test_numbers_without_rounding_errors(tmp_path):
    """-0.3/3 is -0.09999999999999999 in doubles; the output has -0.1."""
    (tmp_path / "system.xml").write_text(
        '<system name="P"><coordinate name="x" velocity="v"/><kinetic>v^2/2</kinetic><force coordinate="x">-0.3*x/3</force></system>'
    )
    result = lagc("--linearize", "system.xml", cwd=tmp_path)
    assert result.stdout.count("[-0.1, 0]") == 2 and "9999" not in result.stdout


def test_units_with_roots(tmp_path):
    """Units in FMI have integer exponents: the root of a metre has no unit, and the product of three cube roots is a metre."""
    outputs = '<output name="a">sqrt(l)</output><output name="b">sqrt(l)*sqrt(l)</output><output name="c">l^(1/3)*l^(1/3)*l^(1/3)</output>'
    result = compile_text(broken(10, outputs), tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    text = (tmp_path / "out" / "modelDescription.xml").read_text()
    units = dict(re.findall(r'<ScalarVariable name="([abc])".*?<Real(?: declaredType="SI.Length")?(?: unit="(.*?)")?/>', text, re.S))
    assert units == {"a": "", "b": "m", "c": "m"} and "0.5" not in text.split("ModelVariables")[0]
