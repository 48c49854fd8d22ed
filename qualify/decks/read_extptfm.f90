! Prints what the ExtPtfm module of OpenFAST 2.4 to 4.2 has read: its matrices, loads and initial positions.
program read_extptfm
   use NWTC_Library
   use ExtPtfm_MCKF
   use ExtPtfm_MCKF_Types
   implicit none
   type(ExtPtfm_InitInputType) :: i
   type(ExtPtfm_InitOutputType) :: o
   type(ExtPtfm_ContinuousStateType) :: x
   type(ExtPtfm_DiscreteStateType) :: xd
   type(ExtPtfm_ConstraintStateType) :: z
   type(ExtPtfm_OtherStateType) :: other
   type(ExtPtfm_MiscVarType) :: m
   type(ExtPtfm_ParameterType) :: p
   type(ExtPtfm_InputType) :: u
   type(ExtPtfm_OutputType) :: y
   real(DbKi) :: dt
   integer :: error
   character(ErrMsgLen) :: message
   call NWTC_Init()
   call get_command_argument(1, i%InputFile)
   i%RootName = 'read_extptfm'
   dt = 0.01_DbKi
   call ExtPtfm_Init(i, u, p, x, xd, z, other, y, m, dt, o, error, message)
   if (error /= 0) then
      write(*, '(A)') 'error '//trim(message)
      if (error >= ErrID_Fatal) stop 1
   end if
   call print_rows('M', p%Mass)
   call print_rows('K', p%Stff)
   call print_rows('C', p%Damp)
   call print_rows('weight_n', p%Forces)
   call print_rows('start', reshape(x%qm, [1, size(x%qm)]))
contains
   subroutine print_rows(name, matrix)
      character(*), intent(in) :: name
      real(ReKi), intent(in) :: matrix(:, :)
      integer :: k
      do k = 1, size(matrix, 1)
         write(*, '(A,10000(1X,ES24.16E3))') name, matrix(k, :)
      end do
   end subroutine
end program
