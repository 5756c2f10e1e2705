! Mohr-Coulomb with non-associated flow and softening as a UMAT: the law mohr_coulomb of Talus (physics/laws/mohr_coulomb.h), without
! tension cut-off, written anew for a point at a time. The tests hold one against the other.
! gfortran -O2 -shared -fPIC mohr_coulomb.f90 -o mohr_coulomb.so
!
! PROPS  1 E [Pa], 2 nu, 3 c, 4 phi, 5 psi [Pa, rad], 6 residual c, 7 residual phi, 8 eta,
!        9 tangent: 0 the elastic stiffness, 1 difference quotients (for an implicit solver)
! STATEV 1 accumulated deviatoric plastic strain, 2 dilation: plastic volume strain where soil shears, not where it opens at the apex
module mohr_coulomb_point
  implicit none
  double precision, parameter :: unlimited = 1d100
  type soil
    double precision :: lambda, g, c, phi, psi, residual_c, residual_phi, eta
  end type soil
contains

  ! Eigenvalues s(1) >= s(2) >= s(3) of a symmetric matrix and its eigenvectors, by Jacobi rotations.
  subroutine eigen(a, s, v)
    double precision, intent(in) :: a(3, 3)
    double precision, intent(out) :: s(3), v(3, 3)
    double precision :: b(3, 3), theta, t, c, sn, r(3, 3), swap(3), value
    integer :: sweep, p, q, i, j
    b = a
    v = reshape([1d0, 0d0, 0d0, 0d0, 1d0, 0d0, 0d0, 0d0, 1d0], [3, 3])
    do sweep = 1, 30
      if (b(1, 2)**2 + b(1, 3)**2 + b(2, 3)**2 <= 1d-300) exit
      do p = 1, 2
        do q = p + 1, 3
          if (abs(b(p, q)) <= 1d-30*(abs(b(p, p)) + abs(b(q, q)))) then
            b(p, q) = 0
            b(q, p) = 0
            cycle
          end if
          theta = (b(q, q) - b(p, p))/(2*b(p, q))
          t = sign(1d0, theta)/(abs(theta) + sqrt(theta**2 + 1))
          c = 1/sqrt(t**2 + 1)
          sn = t*c
          r = reshape([1d0, 0d0, 0d0, 0d0, 1d0, 0d0, 0d0, 0d0, 1d0], [3, 3])
          r(p, p) = c
          r(q, q) = c
          r(p, q) = sn
          r(q, p) = -sn
          b = matmul(transpose(r), matmul(b, r))
          v = matmul(v, r)
        end do
      end do
    end do
    do i = 1, 3
      s(i) = b(i, i)
    end do
    do i = 1, 2
      do j = i + 1, 3
        if (s(j) > s(i)) then
          value = s(i); s(i) = s(j); s(j) = value
          swap = v(:, i); v(:, i) = v(:, j); v(:, j) = swap
        end if
      end do
    end do
  end subroutine eigen

  ! Cohesion and friction angle after a plastic strain, and the tension that they bear.
  subroutine strength(m, plastic_strain, c, phi, limit)
    type(soil), intent(in) :: m
    double precision, intent(in) :: plastic_strain
    double precision, intent(out) :: c, phi, limit
    double precision :: left
    left = exp(-m%eta*plastic_strain)
    phi = m%residual_phi + (m%phi - m%residual_phi)*left
    c = m%residual_c + (m%c - m%residual_c)*left
    limit = unlimited
    if (sin(phi) > 0) limit = c*cos(phi)/sin(phi)
  end subroutine strength

  ! Principal stresses that plastic flow leaves of a trial, at the strength after `plastic_strain`.
  function admissible(m, s, plastic_strain) result(x)
    type(soil), intent(in) :: m
    double precision, intent(in) :: s(3), plastic_strain
    double precision :: x(3), phi, c, sphi, spsi, k, limit, side, greater, less, f, drop, gap12, gap23, d(3), slip
    double precision :: plane2, plane3, line3, opened3, low, det, drop1, drop3, line_slip, line_opening, middle
    logical :: upper
    call strength(m, plastic_strain, c, phi, limit)
    sphi = sin(phi)
    spsi = min(sin(m%psi), sphi)
    k = 2*c*cos(phi)
    side = 2*m%lambda*spsi
    greater = side + 2*m%g*(1 + spsi)
    less = side - 2*m%g*(1 - spsi)
    x = s
    f = (1 + sphi)*s(1) - (1 - sphi)*s(3) - k
    if (f > 0) then
      drop = (1 + sphi)*greater - (1 - sphi)*less
      gap12 = (s(1) - s(2))*(1 - spsi)
      gap23 = (s(2) - s(3))*(1 + spsi)
      upper = gap12 < gap23
      d = [greater, side, less]
      if (min(gap12, gap23)*drop < 2*m%g*(1 - spsi**2)*f) then
        if (upper) then
          x(1:2) = (s(1) + s(2))/2
          d(1:2) = (greater + side)/2
        else
          x(2:3) = (s(2) + s(3))/2
          d(2:3) = (side + less)/2
        end if
      end if
      slip = ((1 + sphi)*x(1) - (1 - sphi)*x(3) - k)/((1 + sphi)*d(1) - (1 - sphi)*d(3))
      x = x - slip*d
    end if
    if (x(1) <= limit) return
    ! the apex: no tension beyond it, alone or together with shear
    plane2 = s(2) - m%lambda/(m%lambda + 2*m%g)*(s(1) - limit)
    plane3 = s(3) - m%lambda/(m%lambda + 2*m%g)*(s(1) - limit)
    line3 = s(3) - m%lambda/(m%lambda + m%g)*((s(1) + s(2))/2 - limit)
    opened3 = min(merge(line3, plane3, plane2 > limit), limit)
    if ((1 + sphi)*limit - (1 - sphi)*opened3 - k <= 0) then
      x = [limit, min(plane2, limit), opened3]
      return
    end if
    low = ((1 + sphi)*limit - k)/(1 - sphi)
    drop1 = s(1) - limit
    drop3 = s(3) - low
    det = 4*m%g*(m%lambda + m%g)*(1 - spsi)
    line_slip = (m%lambda*drop1 - (m%lambda + 2*m%g)*drop3)/det
    line_opening = (greater*drop3 - less*drop1)/det
    middle = s(2) - side*line_slip - m%lambda*line_opening
    x = [limit, max(min(middle, limit), low), low]
  end function admissible

  ! Deviatoric plastic strain of a return.
  function shearing(m, change) result(e)
    type(soil), intent(in) :: m
    double precision, intent(in) :: change(3)
    double precision :: e
    e = sqrt((change(1) - change(2))**2 + (change(2) - change(3))**2 + (change(3) - change(1))**2)*sqrt(2d0)/3/(2*m%g)
  end function shearing

  subroutine update(m, ntens, stress, statev, dstran)
    type(soil), intent(in) :: m
    integer, intent(in) :: ntens
    double precision, intent(inout) :: stress(ntens), statev(2)
    double precision, intent(in) :: dstran(ntens)
    double precision :: a(3, 3), s(3), v(3, 3), x(3), change(3), predicted, c, phi, limit, volume
    integer :: i
    volume = dstran(1) + dstran(2) + dstran(3)
    stress(1:3) = stress(1:3) + m%lambda*volume + 2*m%g*dstran(1:3)
    stress(4:) = stress(4:) + m%g*dstran(4:)
    a = 0
    do i = 1, 3
      a(i, i) = stress(i)
    end do
    a(1, 2) = stress(4)
    if (ntens == 6) then
      a(1, 3) = stress(5)
      a(2, 3) = stress(6)
    end if
    a(2, 1) = a(1, 2)
    a(3, 1) = a(1, 3)
    a(3, 2) = a(2, 3)
    call eigen(a, s, v)
    predicted = statev(1) + shearing(m, s - admissible(m, s, statev(1)))
    x = admissible(m, s, predicted)
    change = s - x
    if (maxval(abs(change)) == 0) return
    statev(1) = statev(1) + shearing(m, change)
    call strength(m, predicted, c, phi, limit)
    if (x(1) < limit) statev(2) = statev(2) + sum(change)/(3*m%lambda + 2*m%g)
    do i = 1, 3
      a = a - change(i)*spread(v(:, i), 2, 3)*spread(v(:, i), 1, 3)
    end do
    stress(1:4) = [a(1, 1), a(2, 2), a(3, 3), a(1, 2)]
    if (ntens == 6) stress(5:6) = [a(1, 3), a(2, 3)]
  end subroutine update
end module mohr_coulomb_point

subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, temp, dtemp, &
                predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, celent, dfgrd0, dfgrd1, &
                noel, npt, layer, kspt, kstep, kinc)
  use mohr_coulomb_point
  implicit none
  integer, intent(in) :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt, kstep, kinc
  character(len=80), intent(in) :: cmname
  double precision, intent(in) :: stran(ntens), dstran(ntens), time(2), dtime, temp, dtemp, predef(1), dpred(1), props(nprops)
  double precision, intent(in) :: coords(3), drot(3, 3), celent, dfgrd0(3, 3), dfgrd1(3, 3)
  double precision, intent(inout) :: stress(ntens), statev(nstatv), sse, spd, scd, rpl, drpldt, pnewdt
  double precision, intent(inout) :: ddsdde(ntens, ntens), ddsddt(ntens), drplde(ntens)
  double precision, parameter :: width = 1d-7
  double precision :: start(6), start_state(2), e(6), there(6), back(6), state(2)
  type(soil) :: m
  integer :: j
  m%g = props(1)/(2*(1 + props(2)))
  m%lambda = 2*m%g*props(2)/(1 - 2*props(2))
  m%c = props(3)
  m%phi = props(4)
  m%psi = props(5)
  m%residual_c = props(6)
  m%residual_phi = props(7)
  m%eta = props(8)
  start(1:ntens) = stress
  start_state = statev(1:2)
  call update(m, ntens, stress, statev(1:2), dstran)
  ddsdde = 0
  do j = 1, ntens
    if (props(9) > 0) then
      e(1:ntens) = dstran
      e(j) = dstran(j) + width
      there(1:ntens) = start(1:ntens)
      state = start_state
      call update(m, ntens, there(1:ntens), state, e(1:ntens))
      e(j) = dstran(j) - width
      back(1:ntens) = start(1:ntens)
      state = start_state
      call update(m, ntens, back(1:ntens), state, e(1:ntens))
      ddsdde(:, j) = (there(1:ntens) - back(1:ntens))/(2*width)
    else if (j <= 3) then
      ddsdde(1:3, j) = m%lambda
      ddsdde(j, j) = m%lambda + 2*m%g
    else
      ddsdde(j, j) = m%g
    end if
  end do
end subroutine umat
