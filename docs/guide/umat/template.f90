! What Talus hands to a UMAT. gfortran -O2 -shared -fPIC template.f90 -o template.so
! Stress and strain are positive in tension, in the order 11, 22, 33, 12 (plane strain) or 11, 22, 33, 12, 13, 23; shear strain is the
! angle. STRESS and STATEV come as they were at the start of the step, already turned by DROT; they leave as they are at its end.
subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, temp, dtemp, &
                predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, celent, dfgrd0, dfgrd1, &
                noel, npt, layer, kspt, kstep, kinc)
  implicit none
  integer, intent(in) :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt, kstep, kinc
  character(len=80), intent(in) :: cmname
  double precision, intent(in) :: stran(ntens), dstran(ntens), time(2), dtime, temp, dtemp, predef(1), dpred(1), props(nprops)
  double precision, intent(in) :: coords(3), drot(3, 3), celent, dfgrd0(3, 3), dfgrd1(3, 3)
  double precision, intent(inout) :: stress(ntens), statev(nstatv), sse, spd, scd, rpl, drpldt, pnewdt
  double precision, intent(inout) :: ddsdde(ntens, ntens), ddsddt(ntens), drplde(ntens)
  double precision :: lambda, g
  integer :: i, j

  ! props = ["lambda", "G"] of linear elasticity: replace from here
  lambda = props(1)
  g = props(2)
  ddsdde = 0
  do i = 1, 3
    do j = 1, 3
      ddsdde(i, j) = lambda
    end do
    ddsdde(i, i) = lambda + 2*g
  end do
  do i = 4, ntens
    ddsdde(i, i) = g
  end do
  stress = stress + matmul(ddsdde, dstran)
end subroutine umat
